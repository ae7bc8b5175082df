"""The shapes that stand for a photographed object: one class a kind, in the module of its name."""
