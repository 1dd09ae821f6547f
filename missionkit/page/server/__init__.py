"""The web server of the page: who may see and do what, and the messages."""
