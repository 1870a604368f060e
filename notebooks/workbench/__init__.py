"""The workbench: a page of widgets to design icons on."""
