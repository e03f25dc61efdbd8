"""Meshes, images and pictures of the gallery: `python tools/gallery.py`."""
