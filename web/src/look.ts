// The direction of the view: angles that follow the mouse or a finger at once and are sent to the
// gateway as they are.

const pitch_max = 1.55;
const radians_per_pixel = 0.0022;
// Some systems report one enormous step when the pointer is captured.
const step_max_pixels = 400;

export class Look {
  /** Radians; 0 looks along −z and grows to the left, in (−π, π]. */
  yaw = 0;
  /** Radians; grows upwards, −1.55 … 1.55. */
  pitch = 0;

  turn(right_pixels: number, down_pixels: number, speed = 1): void {
    if (Math.abs(right_pixels) > step_max_pixels || Math.abs(down_pixels) > step_max_pixels) return;
    this.set(
      this.yaw - right_pixels * radians_per_pixel * speed,
      this.pitch - down_pixels * radians_per_pixel * speed,
    );
  }

  set(yaw: number, pitch: number): void {
    if (!Number.isFinite(yaw) || !Number.isFinite(pitch)) return;
    this.yaw = Math.atan2(Math.sin(yaw), Math.cos(yaw));
    this.pitch = Math.min(pitch_max, Math.max(-pitch_max, pitch));
  }
}
