// A headless Chromium driven through its debugging pipe (fd 3 and 4, JSON ended by NUL): no packages.
import { spawn } from "node:child_process";
import { mkdtemp, rm } from "node:fs/promises";
import { tmpdir } from "node:os";
import { join } from "node:path";

export async function launch(program = process.env.CHROMIUM ?? "chromium") {
  const profile = await mkdtemp(join(tmpdir(), "medial-web-"));
  const browser = spawn(program, [
    "--headless=new", "--no-sandbox", "--remote-debugging-pipe", `--user-data-dir=${profile}`,
    "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist",
    // WebGPU by SwiftShader, where there is no better.
    "--enable-unsafe-webgpu",
    "--hide-scrollbars", "--no-first-run", "--disable-background-networking", "--disable-component-update",
    "--disable-sync", "--disable-quic", "--disable-dev-shm-usage", "about:blank",
  ], { stdio: ["ignore", "ignore", "pipe", "pipe", "pipe"] });
  const [, , errors, input, output] = browser.stdio;
  let log = "";
  errors.on("data", (data) => (log = (log + data).slice(-4000)));

  let number = 0;
  let rest = "";
  const waiting = new Map();
  const listeners = [];
  output.setEncoding("utf8");
  output.on("data", (data) => {
    const messages = (rest + data).split("\0");
    rest = messages.pop();
    for (const message of messages.map(JSON.parse)) {
      const { resolve, reject } = waiting.get(message.id) ?? {};
      waiting.delete(message.id);
      if (message.error) reject?.(new Error(message.error.message));
      else if (message.id) resolve?.(message.result);
      else listeners.forEach((listener) => listener(message));
    }
  });
  const ended = new Promise((resolve) => browser.on("exit", resolve));
  browser.on("error", () => {});
  ended.then(() => waiting.forEach(({ reject }) => reject(new Error(`the browser ended: ${log}`))));
  const send = (method, params = {}, sessionId) =>
    new Promise((resolve, reject) => {
      number += 1;
      waiting.set(number, { resolve, reject });
      input.write(JSON.stringify({ id: number, method, params, sessionId }) + "\0");
    });

  // A page of a size, and what it has written as errors; `first` is run before the page's own code.
  async function open(url, { width, height, mobile }, first = "") {
    const { targetId } = await send("Target.createTarget", { url: "about:blank" });
    const { sessionId } = await send("Target.attachToTarget", { targetId, flatten: true });
    const call = (method, params) => send(method, params, sessionId);
    const errors = [];
    listeners.push(({ method, params, sessionId: from }) => {
      if (from !== sessionId) return;
      if (method === "Runtime.exceptionThrown") errors.push(params.exceptionDetails.text + " " + (params.exceptionDetails.exception?.description ?? ""));
      if (method === "Runtime.consoleAPICalled" && params.type === "error") errors.push(params.args.map((a) => a.value ?? a.description).join(" "));
      if (method === "Log.entryAdded" && params.entry.level === "error") errors.push(params.entry.text);
    });
    await Promise.all(["Runtime.enable", "Log.enable", "Page.enable"].map((method) => call(method)));
    await call("Emulation.setDeviceMetricsOverride", { width, height, mobile, deviceScaleFactor: mobile ? 2 : 1 });
    if (mobile) await call("Emulation.setTouchEmulationEnabled", { enabled: true, maxTouchPoints: 2 });
    await call("Page.addScriptToEvaluateOnNewDocument", { source: first });
    await call("Page.navigate", { url });

    async function value(expression) {
      const { result, exceptionDetails } = await call("Runtime.evaluate", { expression, returnByValue: true, awaitPromise: true });
      if (exceptionDetails) throw new Error(`${expression}: ${exceptionDetails.exception?.description}`);
      return result.value;
    }
    async function until(expression, seconds) {
      const end = Date.now() + 1000 * seconds;
      while (!(await value(expression))) {
        if (errors.length > 0 || Date.now() > end) throw new Error(`not within ${seconds} s: ${expression}; errors: ${errors.join("; ")}`);
        await new Promise((resolve) => setTimeout(resolve, 100));
      }
    }
    const mouse = (type, x, y, more) => call("Input.dispatchMouseEvent", { type, x, y, button: "left", ...more });
    async function clickAt(x, y) {
      await mouse("mousePressed", x, y, { clickCount: 1 });
      await mouse("mouseReleased", x, y, { clickCount: 1 });
    }
    // A click where the element is, as a user's: on what is seen there.
    async function click(selector) {
      const name = JSON.stringify(selector);
      const [x, y, seen] = await value(`(() => {
        const element = document.querySelector(${name});
        element.scrollIntoView({ block: "nearest" });
        const r = element.getBoundingClientRect();
        const at = [r.x + r.width / 2, r.y + r.height / 2];
        const top = document.elementFromPoint(...at);
        return [...at, r.width > 0 && (element.contains(top) || top?.contains(element))];
      })()`);
      if (!seen) throw new Error(`${selector} is not seen at (${x}, ${y})`);
      await clickAt(x, y);
    }
    async function drag([x, y], [toX, toY]) {
      await mouse("mousePressed", x, y, { clickCount: 1 });
      for (const part of [0.25, 0.5, 0.75, 1]) {
        await mouse("mouseMoved", x + part * (toX - x), y + part * (toY - y), { buttons: 1 });
      }
      await mouse("mouseReleased", toX, toY, { clickCount: 1 });
    }
    const wheel = (x, y, deltaY) => call("Input.dispatchMouseEvent", { type: "mouseWheel", x, y, deltaX: 0, deltaY });
    async function touch(...frames) {
      for (const [k, points] of frames.entries()) {
        const touchPoints = points.map(([x, y], id) => ({ x, y, id }));
        await call("Input.dispatchTouchEvent", { type: k === 0 ? "touchStart" : "touchMove", touchPoints });
      }
      await call("Input.dispatchTouchEvent", { type: "touchEnd", touchPoints: [] });
    }
    async function key(key) {
      const text = key.length === 1 ? key : undefined;
      await call("Input.dispatchKeyEvent", { type: "keyDown", key, text });
      await call("Input.dispatchKeyEvent", { type: "keyUp", key });
    }
    async function choose(selector, file) {
      const { root } = await call("DOM.getDocument");
      const { nodeId } = await call("DOM.querySelector", { nodeId: root.nodeId, selector });
      await call("DOM.setFileInputFiles", { nodeId, files: [file] });
    }
    async function picture() {
      const { data } = await call("Page.captureScreenshot", { format: "png" });
      return Buffer.from(data, "base64");
    }
    return { value, until, click, clickAt, drag, wheel, touch, key, choose, picture, errors, close: () => send("Target.closeTarget", { targetId }) };
  }

  async function close() {
    send("Browser.close").catch(() => {});
    await ended;
    await rm(profile, { recursive: true, force: true, maxRetries: 5 });
  }
  return { open, close };
}
