"""Even pictures and tiles (MJHRW17): measures of evenness and toroidal synthesis."""
