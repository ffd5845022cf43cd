"""JSON to trees. Imported only when a text in JSON is read, or a tree is written as one."""
