"""Errors that a user can act on."""


class VoldetailError(Exception):
    """Base of every error that voldetail raises on purpose; its text is one sentence for the user."""


class InputError(VoldetailError):
    """Something the user gave cannot be used: the text says what, where, what is allowed and what to do."""
