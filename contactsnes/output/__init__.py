"""Archives, tables and figures."""
