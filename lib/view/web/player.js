// Control bar of a recorded drive: play, step, slide.

const kSpeeds = [0.5, 1, 2, 5, 10, 30];

class Player {
  // `drive` has numSteps, step, timeOf(step) [s], stepAt(seconds), show(step).
  constructor(drive, box) {
    this.drive = drive;
    this.isPlaying = false;
    box.hidden = false;
    const button = (id, words, title, act) => {
      const made = element("button", { type: "button", id, className: "icon", textContent: words, title });
      made.addEventListener("click", act);
      return made;
    };
    this.playButton = button("play", "▶", "Play or pause (space)", () => this.toggle());
    this.slider = element("input", { type: "range", id: "slider", min: 0, max: 0, step: 1, value: 0 });
    this.slider.setAttribute("aria-label", "Time in the drive");
    this.slider.addEventListener("input", () => { this.pause(); drive.show(Number(this.slider.value)); });
    this.speed = element("select", { id: "speed", title: "Speed", ariaLabel: "Speed" },
      ...kSpeeds.map((value) => element("option", { value: String(value), textContent: `${value}×`, selected: value === 1 })));
    this.words = element("span", { id: "player-words" });
    box.replaceChildren(
      element("div", { className: "player-line" }, this.playButton,
        button("step-back", "‹", "Previous scan (,)", () => this.stepBy(-1)),
        button("step-on", "›", "Next scan (.)", () => this.stepBy(1)), this.words, this.speed),
      this.slider);
    document.addEventListener("keydown", (event) => this.key(event));
  }

  key(event) {
    if (/^(INPUT|TEXTAREA|SELECT|BUTTON)$/.test(event.target.tagName)) return;
    if (event.key === " ") this.toggle();
    else if (event.key === ",") this.stepBy(-1);
    else if (event.key === ".") this.stepBy(1);
    else return;
    event.preventDefault();
  }

  // Called after a step was shown or further steps were loaded.
  update() {
    const { drive } = this;
    this.slider.max = String(Math.max(0, drive.numSteps - 1));
    this.slider.value = String(drive.step);
    const state = drive.isDone ? "" : drive.problem || `mapping, ${Math.round(100 * drive.share)} %`;
    const time = drive.numSteps === 0 ? "" :
      `${clockText(drive.timeOf(drive.step))} / ${clockText(drive.timeOf(drive.numSteps - 1))} · ` +
      `${wholeNumber(drive.step + 1)}/${wholeNumber(drive.numSteps)}`;
    this.words.textContent = [time, state].filter((words) => words).join(" · ");
    this.words.title = `scan ${wholeNumber(drive.step + 1)} of ${wholeNumber(drive.numSteps)}`;
  }

  stepBy(number) {
    this.pause();
    this.drive.show(this.drive.step + number);
  }

  toggle() {
    if (this.isPlaying) { this.pause(); return; }
    if (this.drive.step >= this.drive.numSteps - 1) this.drive.show(0);
    this.isPlaying = true;
    this.playButton.textContent = "⏸";
    this.clock_s = this.drive.timeOf(this.drive.step);
    this.last = null;
    requestAnimationFrame((now) => this.tick(now));
  }

  pause() {
    this.isPlaying = false;
    this.playButton.textContent = "▶";
  }

  tick(now) {
    if (!this.isPlaying) return;
    const { drive } = this;
    if (this.last !== null) this.clock_s += Math.min(0.5, (now - this.last) / 1000) * Number(this.speed.value);
    this.last = now;
    const end_s = drive.timeOf(drive.numSteps - 1);
    this.clock_s = Math.min(this.clock_s, end_s);
    const step = drive.stepAt(this.clock_s);
    if (step !== drive.step) drive.show(step);
    if (drive.isDone && this.clock_s >= end_s) this.pause();
    else requestAnimationFrame((time) => this.tick(time));
  }
}

function clockText(seconds) {
  const minutes = Math.floor(seconds / 60);
  return `${minutes}:${(seconds - 60 * minutes).toFixed(1).padStart(4, "0")}`;
}
