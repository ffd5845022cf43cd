"""World files: checked, drawn, made from maps and way points of other programs, and written for them."""
