// Pictures onto the canvas: decoded off the main thread, only the newest one is ever shown, and
// each one is acknowledged.

import { Picture } from "./protocol";

export interface LastPicture {
  number: number;
  width: number;
  height: number;
  world_time_us: number;
  input_seq: number;
  bytes: number;
  render_ms: number;
}

export interface DisplayHandlers {
  /** This picture is finished with: decoded, passed over for a newer one, or broken. */
  on_finished(number: number): void;
  on_problem(sentence: string): void;
  on_first_picture(): void;
}

// Pictures whose acknowledgement is still due. The gateway's window is far smaller; one that
// ignores it shall not fill memory.
const owed_max = 256;

export class Display {
  frames_decoded = 0;
  frames_shown = 0;
  frames_dropped = 0;
  last_picture: LastPicture | null = null;
  last_arrival_ms = 0;

  private readonly context_: ImageBitmapRenderingContext;
  private next_: Picture | null = null;
  private decoding_ = false;
  private ready_: { bitmap: ImageBitmap; picture: Picture } | null = null;
  private owed_: number[] = [];
  private generation_ = 0;

  constructor(
    private readonly canvas_: HTMLCanvasElement,
    private readonly handlers_: DisplayHandlers,
  ) {
    const context = canvas_.getContext("bitmaprenderer");
    if (context === null) throw new Error("This browser cannot draw pictures on a canvas.");
    this.context_ = context;
    document.addEventListener("visibilitychange", () => this.settle());
  }

  offer(picture: Picture): void {
    this.last_arrival_ms = performance.now();
    this.owed_.push(picture.number);
    if (this.owed_.length > owed_max) this.owed_.shift();
    if (this.next_ !== null) this.frames_dropped++;
    this.next_ = picture;
    if (!this.decoding_) void this.decode();
  }

  /**
   * The connection is gone: nothing of the old one is owed, decoded or shown any more. The last
   * picture stays.
   */
  forget(): void {
    this.generation_++;
    this.next_ = null;
    this.owed_ = [];
    this.ready_?.bitmap.close();
    this.ready_ = null;
  }

  private async decode(): Promise<void> {
    this.decoding_ = true;
    while (this.next_ !== null) {
      const picture = this.next_;
      const generation = this.generation_;
      this.next_ = null;
      let bitmap: ImageBitmap | null = null;
      try {
        bitmap = await createImageBitmap(new Blob([picture.jpeg], { type: "image/jpeg" }));
      } catch {
        this.handlers_.on_problem(`picture ${picture.number} could not be decoded`);
      }
      if (generation !== this.generation_) {
        bitmap?.close();
        continue;
      }
      if (bitmap !== null) this.make_ready(bitmap, picture);
      this.settle();
    }
    this.decoding_ = false;
  }

  private make_ready(bitmap: ImageBitmap, picture: Picture): void {
    this.frames_decoded++;
    if (this.ready_ === null) requestAnimationFrame(() => this.show());
    else {
      this.ready_.bitmap.close();
      this.frames_dropped++;
    }
    this.ready_ = { bitmap, picture };
  }

  private show(): void {
    if (this.ready_ === null) return;
    const { bitmap, picture } = this.ready_;
    this.ready_ = null;
    const { width, height } = bitmap;
    if (this.canvas_.width !== width) this.canvas_.width = width;
    if (this.canvas_.height !== height) this.canvas_.height = height;
    this.context_.transferFromImageBitmap(bitmap);
    this.frames_shown++;
    const { number, world_time_us, input_seq, render_ms, jpeg } = picture;
    this.last_picture = {
      number,
      width,
      height,
      world_time_us,
      input_seq,
      bytes: jpeg.length,
      render_ms,
    };
    if (this.frames_shown === 1) this.handlers_.on_first_picture();
  }

  /**
   * Acknowledges all pictures before the one that waits. A hidden page does not, so that nothing is
   * drawn for nobody.
   */
  private settle(): void {
    if (document.hidden) return;
    const waiting = this.next_?.number;
    while (this.owed_.length > 0 && this.owed_[0] !== waiting) {
      this.handlers_.on_finished(this.owed_.shift() as number);
    }
  }
}

const step_width = 64;
const step_height = 36;
const steps_min = 5;
const steps_max = 20;

/**
 * The view to ask for: 16:9, large enough for the window, at most 1280 × 720. Sizes come in steps
 * of 64 × 36 pixels, so that
 * dragging the window's edge does not ask for a new size at every pixel.
 */
export function fitting_size(window_width: number, window_height: number, pixel_ratio: number) {
  const width = Math.min(window_width, (window_height * 16) / 9) * pixel_ratio;
  const steps = Math.min(steps_max, Math.max(steps_min, Math.ceil(width / step_width - 0.01)));
  return { width: steps * step_width, height: steps * step_height };
}
