"""How the network of recover is trained: on reliefs and paints that voldetail makes itself, and on no photograph."""
