// JPEG pictures for the mock gateway, drawn by Chromium's own canvas: a walk over a plain of
// coloured balls.

/**
 * @returns {Promise<{width: number, height: number, jpegs: Buffer[]}>} one picture for every half
 * metre walked.
 */
export async function draw_pictures(browser, { count = 8, width = 1280, height = 720 } = {}) {
  const page = await browser.newPage();
  try {
    const encoded = await page.evaluate(draw_walk, { count, width, height });
    return { width, height, jpegs: encoded.map((text) => Buffer.from(text, "base64")) };
  } finally {
    await page.close();
  }
}

// Runs in the page.
function draw_walk({ count, width, height }) {
  const canvas = document.createElement("canvas");
  canvas.width = width;
  canvas.height = height;
  const context = canvas.getContext("2d", { alpha: false });
  const horizon = height * 0.42;
  const eye_m = 1.7;
  const focal = width * 0.62;
  let seed = 7;
  const random = () => (seed = (seed * 16807) % 2147483647) / 2147483647;
  const palette = ["#e8b04b", "#c9553f", "#5a8fb8", "#7fa86b", "#d9d3c5", "#8a6fb0"];
  const balls = Array.from({ length: 90 }, () => ({
    x: (random() - 0.5) * 46,
    z: 4 + random() * 60,
    radius: 0.3 + random() * 0.7,
    colour: palette[Math.floor(random() * palette.length)],
  })).sort((a, b) => b.z - a.z);
  const pictures = [];
  for (let i = 0; i < count; i++) {
    const walked = i * 0.5;
    const sky = context.createLinearGradient(0, 0, 0, horizon);
    sky.addColorStop(0, "#5f86ad");
    sky.addColorStop(1, "#dfe3e0");
    context.fillStyle = sky;
    context.fillRect(0, 0, width, horizon);
    const ground = context.createLinearGradient(0, horizon, 0, height);
    ground.addColorStop(0, "#c9ccc6");
    ground.addColorStop(1, "#757d76");
    context.fillStyle = ground;
    context.fillRect(0, horizon, width, height - horizon);
    context.strokeStyle = "rgb(255 255 255 / 22%)";
    for (let z = 2 - (walked % 2); z < 80; z += 2) {
      const y = horizon + (focal * eye_m) / Math.max(z, 0.3);
      context.strokeRect(-5, y, width + 10, 0);
    }
    for (let x = -60; x <= 60; x += 2) {
      context.beginPath();
      context.moveTo(width / 2 + (x * focal) / 80, horizon);
      context.lineTo(width / 2 + (x * focal) / 1, horizon + focal * eye_m);
      context.stroke();
    }
    for (const ball of balls) {
      const z = ball.z - walked;
      if (z < 1) continue;
      const scale = focal / z;
      const x = width / 2 + ball.x * scale;
      const y = horizon + (eye_m - ball.radius) * scale;
      const r = ball.radius * scale;
      context.fillStyle = "rgb(20 24 30 / 30%)";
      context.beginPath();
      context.ellipse(x, horizon + eye_m * scale, r, r * 0.25, 0, 0, 7);
      context.fill();
      const light = context.createRadialGradient(x - r * 0.35, y - r * 0.4, r * 0.1, x, y, r);
      light.addColorStop(0, "#fff");
      light.addColorStop(0.25, ball.colour);
      light.addColorStop(1, "#22262c");
      context.fillStyle = light;
      context.beginPath();
      context.arc(x, y, r, 0, 7);
      context.fill();
    }
    pictures.push(canvas.toDataURL("image/jpeg", 0.75).split(",")[1]);
  }
  return pictures;
}
