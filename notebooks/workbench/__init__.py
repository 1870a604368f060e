"""The workbench: models, views, widgets."""
