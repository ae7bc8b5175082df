"""The commands: a module a command, which holds a function of its own name; a package is a group of them."""
