"""The workbench: models, views and widgets."""
