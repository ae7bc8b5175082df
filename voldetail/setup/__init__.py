"""What a photo is of and how a detail is fitted to it: frozen records, their files, lights and views."""
