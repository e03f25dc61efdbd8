"""Other renderers in Abbe's scenes, and scenes made only for the chart."""
