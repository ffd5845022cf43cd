"""Bodies of robots: what robot files and gesture files describe. The files that ship are beside the modules."""
