"""Methods compared on one scene, on equal terms."""
