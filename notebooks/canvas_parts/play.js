// The preview: time runs through the curves that are here already, and a patch of skin takes the colour and the size of
// what is felt. The browser keeps the time, so a busy kernel changes nothing; no hardware is ever driven.

const SPEEDS = [[0.5, "½ speed"], [1, "real time"], [2, "2 × speed"]];
const STEP_S = 0.5; // where the system asks for less motion, time steps by this
const HALF_SIZE_DPRIME = 8; // half of the patch's area; it never grows beyond its place
const LEAST_DPRIME = 1; // below the threshold of detection the patch stays grey
const PREDICTED = "predicted; nothing is driven";
const OCTAVE_K = 6; // change of the skin that is an octave of the tone

/** What is felt at a time of a frame: temperatures, strength (d′) and its quality, "cold", "warm" or "". */
function feltAt(frame, t) {
  const at = (panel, key) => {
    const series = frame.panels.find((each) => each.key === panel)?.series.find((each) => each.key === key);
    return series ? valueAt(frame.arrays[series.buffer], frame.time, t, false) : NaN;
  };
  const [cold, warm] = ["cold", "warm"].map((key) => at("sensation", key) || 0);
  const strength = Math.max(cold, warm, 0);
  const quality = !frame.play.felt || strength < LEAST_DPRIME ? "" : cold > warm ? "cold" : "warm";
  return { skin: at("temperature", "skin"), display: at("temperature", "display"), strength, quality };
}

/** The patch of skin with a few words beside it. */
class Patch {
  constructor() {
    this.spot = make("span", { class: "tm-spot" });
    this.word = make("b", { class: "tm-felt" });
    this.numbers = make("span", { class: "tm-felt-numbers" });
    this.about = make("span", { class: "tm-predicted" }, PREDICTED);
    const title = "colour: what is felt, blue cold, orange warm, grey nothing; size: its strength (receptor clock); felt: the onset (response clock)";
    this.element = make("div", { class: "tm-patch", title }, make("span", { class: "tm-skin", "aria-hidden": true }, this.spot),
      make("span", { class: "tm-patch-words" }, this.word, this.numbers, this.about));
  }

  show(frame, t) {
    const { skin, display, strength, quality } = feltAt(frame, t);
    const { felt, onset, share } = frame.play;
    this.spot.style.transform = `scale(${(0.12 + 0.88 * Math.sqrt(strength / (strength + HALF_SIZE_DPRIME))).toFixed(3)})`;
    if (this.spot.dataset.quality !== quality) this.spot.dataset.quality = quality;
    const unfelt = `not felt${share === null ? "" : ` (reported in ${numberText(100 * share, 0)} % of trials)`}`;
    setText(this.word, !felt ? unfelt : t < onset ? "not yet reported" : `felt${quality ? `: ${quality}` : ", now faded"}`);
    setText(this.numbers, `display ${numberText(display, 1)}, skin ${numberText(skin, 1)} °C, d′ ${numberText(strength, 1)}`);
    this.element.classList.toggle("tm-is-felt", felt && t >= onset);
  }
}

/** Runs time through one frame after another; `say` tells screen readers of onset, quality and end. */
class Run {
  constructor(say) {
    Object.assign(this, { say, speed: 1, raf: 0, tone: new Tone(), still: matchMedia("(prefers-reduced-motion: reduce)") });
  }

  get playing() {
    return this.raf !== 0;
  }

  /** Plays what `frame()` holds, which may change on the way; `show(t)` draws, and `end()` follows, unless it is stopped. */
  start(frame, show, end, name) {
    this.stop();
    Object.assign(this, { frame, show, end, name, at: frame().time.t0, last: performance.now(), told: false });
    if (!frame().play.felt) this.say(`Playing ${name}. It is not felt.`);
    this.raf = requestAnimationFrame((now) => this.tick(now));
  }

  tick(now) {
    const frame = this.frame();
    const { until, felt, onset, quality } = frame.play;
    this.at = Math.min(until, this.at + (Math.max(0, now - this.last) / 1000) * this.speed);
    this.last = Math.max(now, this.last);
    const over = this.at >= until;
    this.show(this.still.matches && !over ? Math.floor(this.at / STEP_S) * STEP_S : this.at);
    this.tone.follow(feltAt(frame, this.at), feltAt(frame, frame.time.t0).skin);
    const heard = felt ? `Felt: ${quality}, ${numberText(onset, 1)} s.` : "Not felt.";
    if (felt && !this.told && this.at >= onset) {
      this.told = true;
      this.say(heard);
    }
    if (!over) this.raf = requestAnimationFrame((next) => this.tick(next));
    else {
      const { end } = this;
      this.say(`End of ${this.name}. ${heard}`);
      this.stop();
      end();
    }
  }

  stop() {
    cancelAnimationFrame(this.raf);
    this.raf = 0;
    this.tone.hush();
  }
}

/** A tone as high as the skin is warm and as loud as what is felt is strong; silent where a browser refuses. */
class Tone {
  constructor() {
    this.on = false;
  }

  /** Called by a click, since browsers want one before they sound. */
  turn(on) {
    this.on = on;
    if (!on) return this.hush();
    try {
      this.context ??= new AudioContext();
      Promise.resolve(this.context.resume()).catch(() => {});
    } catch {
      this.context = null;
    }
  }

  follow({ skin, strength }, rest) {
    if (!this.on || !this.context) return;
    if (!this.voice) {
      this.loud = new GainNode(this.context, { gain: 0 });
      this.voice = new OscillatorNode(this.context);
      this.voice.connect(this.loud).connect(this.context.destination);
      this.voice.start();
    }
    const soon = [this.context.currentTime, 0.02];
    if (Number.isFinite(skin)) this.voice.frequency.setTargetAtTime(330 * 2 ** ((skin - rest) / OCTAVE_K), ...soon);
    this.loud.gain.setTargetAtTime((0.2 * strength) / (strength + HALF_SIZE_DPRIME), ...soon);
  }

  hush() {
    this.voice?.stop();
    this.voice = null;
  }
}
