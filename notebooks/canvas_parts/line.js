// The direct line to a kernel on this machine, for steps of a drag or slider: see direct_line.py. Without it they go by
// Jupyter.

const OWN_MACHINE = ["localhost", "127.0.0.1", "[::1]"];

class Line {
  /** `onFrame(meta, buffers)` is called with each frame, `onEnd` when an open connection closes. */
  constructor(onFrame, onEnd) {
    Object.assign(this, { onFrame, onEnd, socket: null });
  }

  /** Whether the page came from this machine, so that the kernel may be here too. */
  static get possible() {
    return OWN_MACHINE.includes(location.hostname);
  }

  get isOpen() {
    return this.socket?.readyState === WebSocket.OPEN;
  }

  open({ port, token }) {
    if (this.socket && this.socket.readyState <= WebSocket.OPEN) return;
    let opened = false;
    const socket = new WebSocket(`ws://127.0.0.1:${port}/${token}`);
    this.socket = socket;
    socket.binaryType = "arraybuffer";
    socket.onopen = () => (opened = true);
    socket.onmessage = ({ data }) => this.onFrame(...unpacked(data));
    socket.onclose = () => opened && socket === this.socket && this.onEnd();
  }

  send(message) {
    this.socket.send(JSON.stringify(message));
  }

  /** Calls `act(key, value)` whenever a slider moves while the line is open; `models` finds a model by its id. */
  async follow(sliders, models, act) {
    this.unfollow();
    const mine = (this.followed = []);
    const find = async (id) => models?.get_model(id); // which throws at once where there is no such model
    for (const [key, id] of Object.entries(sliders ?? {})) {
      const slider = await find(id).catch(() => null);
      if (!slider || mine !== this.followed) continue;
      const tell = () => this.isOpen && act(key, slider.get("value"));
      slider.on("change:value", tell);
      mine.push(() => slider.off("change:value", tell));
    }
  }

  unfollow() {
    for (const leave of this.followed ?? []) leave();
    this.followed = null;
  }

  stop() {
    this.unfollow();
    const { socket } = this;
    this.socket = null;
    socket?.close();
  }
}

/** Description and buffers of a frame: a length, JSON of that length, and the buffers one after the other. */
function unpacked(data) {
  const size = new DataView(data).getUint32(0, true);
  const meta = JSON.parse(new TextDecoder().decode(new Uint8Array(data, 4, size)));
  let at = 4 + size;
  const buffers = meta.lengths.map((length) => new Float32Array(data, (at += length) - length, length >> 2));
  return [meta, buffers];
}
