"""Pages that are written from the code: commands, parameters, records, rooms, equations. Each part returns Markdown."""
