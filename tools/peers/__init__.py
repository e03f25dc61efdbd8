"""Other renderers in Abbe's scenes, and the scenes that the chart has of its own."""
