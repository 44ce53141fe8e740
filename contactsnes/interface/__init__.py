"""What meets at the interface: traction laws, elastic bodies, shapes and rough surfaces."""
