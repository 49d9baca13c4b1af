// The body or static that is selected: who it is, and what is known of it.

export class Selection {
  /**
   * @param {{world: import("./world.js").World, toolbox: import("./toolbox.js").Toolbox, watch: (slot: number | null) => void,
   *   scene: () => any, picture: () => import("./picture.js").Picture | null, step_s: () => number}} app
   */
  constructor(app) {
    this.app = app;
    this.body = null; // {slot, id}
    this.staticId = null;
    this.told = null; // what the overseer says of it
  }

  /** @param {{slot?: number, staticId?: number} | null} what */
  choose(what) {
    const { world } = this.app;
    this.told = null;
    this.staticId = what?.staticId ?? null;
    this.body = what?.slot !== undefined && world.isAlive(what.slot) ? { slot: what.slot, id: world.id[what.slot] } : null;
    this.app.watch(this.body?.slot ?? null);
    this.refresh();
  }

  /** After frames: is it still there, perhaps under another slot? */
  follow() {
    if (!this.body) return;
    const slot = this.app.world.slotOfId.get(this.body.id);
    if (slot === undefined) this.choose(null);
    else if (slot !== this.body.slot) this.choose({ slot });
  }

  /** @param {any} message  "body" */
  tell(message) {
    if (!this.body || message.id !== this.body.id) return;
    if (message.gone) return this.choose(null);
    this.told = message;
    this.refresh();
  }

  refresh() {
    const { world, toolbox, picture } = this.app;
    if (picture()) picture().selectedSlot = this.body?.slot ?? null;
    if (this.staticId !== null) {
      const body = this.app.scene()?.statics.find((s) => s.id === this.staticId);
      return body ? toolbox.showStatic(body) : this.choose(null);
    }
    if (!this.body) return toolbox.showNothing();
    const { slot, id } = this.body;
    const v = [0, 0, 0];
    const speed = world.velocity(slot, v) ? Math.hypot(...v) / this.app.step_s() : 0;
    const prototype = this.app.scene()?.prototypes[world.prototype[slot]]?.name ?? "";
    toolbox.showBody({ speed, prototype, awake: !world.isAsleep(slot), ...this.told, id, host: world.host[slot],
      epoch: world.epoch[slot], p: world.position(slot) });
  }

  /** @returns {object | null} the command that takes it away */
  removal() {
    if (this.body) return { kind: "remove", body: this.body.id };
    if (this.staticId !== null) return { kind: "remove", static: this.staticId };
    return null;
  }
}
