// What protocol/WIRE_FORMAT.md demands of a browser, as a checker that names the rule a message
// breaks.

const actions = ["throw", "grab", "blast", "respawn"];

/** One for each connection: remembers `seq`, the rate, and which pictures were acknowledged. */
export class ClientRules {
  constructor() {
    this.joined = false;
    this.seq = 0;
    this.arrivals_ms = [];
    this.inputs_ms = [];
    this.acked = new Set();
    this.sent = new Set();
  }

  /** @returns {string | null} the rule that is broken. */
  check(text, now_ms) {
    if (Buffer.byteLength(text) > 4096)
      return `a message of ${Buffer.byteLength(text)} bytes, more than 4096`;
    this.arrivals_ms = this.arrivals_ms.filter((at) => now_ms - at < 1000);
    this.arrivals_ms.push(now_ms);
    if (this.arrivals_ms.length > 400) return "more than 400 messages in a second";
    let message;
    try {
      message = JSON.parse(text);
    } catch {
      return "a message that is not JSON";
    }
    if (!this.joined && message.type !== "join") return `${message.type} before join`;
    return this.check_fields(message, now_ms);
  }

  check_fields(message, now_ms) {
    const within = (value, min, max) => typeof value === "number" && value >= min && value <= max;
    const whole = (value, min, max) => Number.isInteger(value) && within(value, min, max);
    const sized = whole(message.width, 160, 1920) && whole(message.height, 90, 1080);
    switch (message.type) {
      case "join":
        if (this.joined) return "a second join";
        this.joined = true;
        if (message.version !== 1) return `version ${message.version}`;
        if (message.token !== undefined && !/^[0-9a-f]{32}$/.test(message.token))
          return "a token that is none";
        if (typeof message.name !== "string" || message.name.length > 24)
          return "a name that is none";
        return sized ? null : `a view of ${message.width} × ${message.height}`;
      case "input":
      case "action":
        if (message.seq !== ++this.seq) return `seq ${message.seq} where ${this.seq} was due`;
        if (!within(message.yaw, -Math.PI - 1e-5, Math.PI + 1e-5)) return `a yaw of ${message.yaw}`;
        if (!within(message.pitch, -1.55, 1.55)) return `a pitch of ${message.pitch}`;
        return message.type === "input"
          ? this.check_input(message, now_ms)
          : this.check_action(message);
      case "view":
        if (typeof message.region_colours !== "boolean" || typeof message.boundaries !== "boolean")
          return "a view without its toggles";
        return sized ? null : `a view of ${message.width} × ${message.height}`;
      case "ack":
        if (!this.sent.has(message.frame))
          return `an ack for picture ${message.frame}, which was not sent`;
        if (this.acked.has(message.frame)) return `a second ack for picture ${message.frame}`;
        this.acked.add(message.frame);
        return null;
      case "ping":
        return typeof message.t === "number" ? null : "a ping without t";
      case "leave":
        return null;
      default:
        return `an unknown type: ${message.type}`;
    }
  }

  check_input(message, now_ms) {
    if (!Number.isInteger(message.keys) || message.keys < 0 || message.keys > 63)
      return `keys ${message.keys}`;
    this.inputs_ms = this.inputs_ms.filter((at) => now_ms - at < 1000);
    this.inputs_ms.push(now_ms);
    // 60 a second, and room for messages that a busy machine delivered in one lump.
    return this.inputs_ms.length > 75 ? "more than 60 inputs in a second" : null;
  }

  check_action(message) {
    if (!actions.includes(message.action)) return `an unknown action: ${message.action}`;
    if (message.action === "throw" && ![1, 2, 3, 4].includes(message.item))
      return `item ${message.item}`;
    return null;
  }
}
