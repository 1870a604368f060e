// Messages to the kernel: at most one in flight, of those that wait only the newest of each kind, no queue.

const ANSWER_MS = 3000;
const KEPT_MEASUREMENTS = 500;
let lastSeq = 0;

/** Rises over all views, and over reloads of the page too, since several of them may talk to one kernel. */
function nextSeq() {
  lastSeq = Math.max(lastSeq + 1, Date.now());
  return lastSeq;
}

class Flow {
  /** `send` takes a message to the kernel; `onLate` is told true when no answer came, false when one came after all. */
  constructor(send, onLate) {
    this.send = send;
    this.onLate = onLate;
    this.waiting = new Map();
    this.inFlight = null;
    this.answered = 0;
    this.sentAt = new Map();
    this.timer = 0;
    this.late = false;
  }

  hello() {
    this.hand({ type: "hello" });
  }

  /** Sends a message now or as soon as the one in flight is answered; returns its seq. */
  post(message) {
    const numbered = { ...message, seq: nextSeq() };
    const kind = message.end ? `${message.type} end` : message.type;
    if (message.end) this.waiting.delete(message.type);
    this.waiting.delete(kind); // so that the newest stands last
    this.waiting.set(kind, numbered);
    this.next();
    return numbered.seq;
  }

  /** Sends a message that needs no answer. */
  tell(message) {
    try {
      Promise.resolve(this.send({ ...message, seq: 0 })).catch(() => {});
    } catch {
      // the banner says it when the next message gets no answer
    }
  }

  next() {
    if (this.inFlight !== null || this.waiting.size === 0) return;
    const [kind, message] = this.waiting.entries().next().value;
    this.waiting.delete(kind);
    this.inFlight = message.seq;
    this.sentAt.set(message.seq, performance.now());
    this.hand(message);
  }

  hand(message) {
    clearTimeout(this.timer);
    this.timer = setTimeout(() => this.giveUp(), ANSWER_MS);
    try {
      Promise.resolve(this.send(message)).catch(() => this.giveUp());
    } catch {
      this.giveUp(); // a closed connection throws; what it says helps nobody who looks at the page
    }
  }

  giveUp() {
    clearTimeout(this.timer);
    this.inFlight = null;
    this.late = true;
    this.onLate(true);
  }

  /** Takes note of a frame; returns when the message that it answers was sent, or null. */
  arrived(seq) {
    const sent = this.sentAt.get(seq) ?? null;
    this.answered = Math.max(this.answered, seq);
    for (const old of this.sentAt.keys()) if (old <= seq) this.sentAt.delete(old);
    if (this.inFlight === null || seq >= this.inFlight) {
      clearTimeout(this.timer);
      this.inFlight = null;
    }
    const wasLate = this.late;
    this.late = false;
    if (wasLate) this.onLate(false);
    this.next();
    return sent;
  }

  stop() {
    clearTimeout(this.timer);
    this.waiting.clear();
  }
}

/** Keeps the times of the newest frames of each view where tests and measurements find them. */
function measure(view, entry) {
  const all = (window.__thermicon ??= {});
  const list = (all[view] ??= []);
  list.push(entry);
  if (list.length > KEPT_MEASUREMENTS) list.splice(0, list.length - KEPT_MEASUREMENTS);
}
