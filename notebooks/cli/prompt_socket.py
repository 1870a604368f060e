"""Kernel sockets that send small messages at once.

TCP holds small packets back until earlier ones are confirmed (Nagle), and pages confirm up to 40 ms late. Each answer
follows the short message that the kernel is busy, so that each would wait.
"""

from typing import Any

from jupyter_server.services.kernels.connection.channels import ZMQChannelsWebsocketConnection


class PromptSocket(ZMQChannelsWebsocketConnection):
    """The connection of a page to its kernel, without waiting."""

    def connect(self) -> Any:
        """Connect, and send small messages at once from then on."""
        self.websocket_handler.set_nodelay(True)
        return super().connect()
