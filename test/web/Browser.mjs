// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Drives headless Chromium by the DevTools protocol over pipes. Needs no packages of npm.

import {spawn} from 'node:child_process';
import {mkdtempSync, rmSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {join} from 'node:path';

export const sleep = (milliseconds) => new Promise((resolve) => setTimeout(resolve, milliseconds));

export class Browser {
  static async start(executable) {
    const browser = new Browser(executable);
    await browser.open();
    return browser;
  }

  constructor(executable) {
    this.folder = mkdtempSync(join(tmpdir(), 'pcs_web_'));
    this.process = spawn(
        executable,
        [
          '--headless=new',
          '--no-sandbox',
          '--use-gl=angle',
          '--use-angle=swiftshader',
          '--enable-unsafe-swiftshader',
          '--ignore-gpu-blocklist',
          '--disable-dev-shm-usage',
          '--no-first-run',
          '--disable-extensions',
          '--disable-background-networking',
          '--hide-scrollbars',
          '--remote-debugging-pipe',
          `--user-data-dir=${this.folder}`,
          'about:blank',
        ],
        {stdio: ['ignore', 'ignore', 'ignore', 'pipe', 'pipe']});
    this.number = 0;
    this.waiting = new Map();
    this.errors = [];  // exceptions and console errors of the page
    let text = '';
    this.process.stdio[4].setEncoding('utf8').on('data', (chunk) => {
      const parts = (text + chunk).split('\0');
      text = parts.pop();
      parts.forEach((part) => this.receive(JSON.parse(part)));
    });
    this.process.on('error', (error) => this.fail(error));
    this.process.on('exit', (code) => this.fail(new Error(`Chromium ended with status ${code}`)));
  }

  fail(error) {
    for (const {reject} of this.waiting.values()) reject(error);
    this.waiting.clear();
  }

  receive(message) {
    const {method, params} = message;
    if (message.id) {
      const {resolve, reject} = this.waiting.get(message.id) || {};
      this.waiting.delete(message.id);
      if (message.error) reject?.(new Error(message.error.message));
      else resolve?.(message.result);
    } else if (method === 'Runtime.exceptionThrown') {
      const {text, exception} = params.exceptionDetails;
      this.errors.push(`${text} ${exception?.description || ''}`);
    } else if (method === 'Runtime.consoleAPICalled' && params.type === 'error') {
      this.errors.push(params.args.map((arg) => arg.value ?? arg.description).join(' '));
    } else if (method === 'Log.entryAdded' && params.entry.level === 'error') {
      this.errors.push(params.entry.text);
    } else if (
        method === 'Network.requestWillBeSent' && /^(https?|wss?):/.test(params.request.url)) {
      this.errors.push(`request to the network: ${params.request.url}`);
    }
  }

  call(method, params = {}) {
    const id = ++this.number;
    return new Promise((resolve, reject) => {
      this.waiting.set(id, {resolve, reject});
      const message = {id, method, params, ...(this.session && {sessionId: this.session})};
      this.process.stdio[3].write(JSON.stringify(message) + '\0');
    });
  }

  async open() {
    const {targetInfos} = await this.call('Target.getTargets');
    const {targetId} = targetInfos.find(({type}) => type === 'page');
    const {sessionId} = await this.call('Target.attachToTarget', {targetId, flatten: true});
    this.session = sessionId;
    for (const domain of ['Page', 'Runtime', 'Log', 'Network']) await this.call(`${domain}.enable`);
  }

  async close() {
    this.process.removeAllListeners('exit');
    const ended = new Promise((resolve) => this.process.once('exit', resolve));
    this.process.kill();
    await ended;
    rmSync(this.folder, {recursive: true, force: true, maxRetries: 5, retryDelay: 200});
  }

  /// Returns the value of an expression of the page; promises are awaited.
  async evaluate(expression) {
    const {result, exceptionDetails} =
        await this.call('Runtime.evaluate', {expression, awaitPromise: true, returnByValue: true});
    if (exceptionDetails)
      throw new Error(exceptionDetails.exception?.description || exceptionDetails.text);
    return result.value;
  }

  /// Waits until an expression of the page is true.
  async until(expression, what, seconds = 120) {
    for (const end = Date.now() + 1000 * seconds; Date.now() < end; await sleep(50))
      if (await this.evaluate(expression)) return;
    throw new Error(`waited ${seconds} s in vain for: ${what}`);
  }

  async resize(width, height, scheme = 'light') {
    await this.call(
        'Emulation.setDeviceMetricsOverride', {width, height, deviceScaleFactor: 1, mobile: false});
    await this.call(
        'Emulation.setEmulatedMedia', {features: [{name: 'prefers-color-scheme', value: scheme}]});
  }

  async mouse(type, x, y, button = 'none', modifiers = 0) {
    await this.call('Input.dispatchMouseEvent', {
      type,
      x,
      y,
      button,
      buttons: {none: 0, left: 1, right: 2}[button],
      modifiers,
      clickCount: 1
    });
  }

  /// Drags from one place to another in steps.
  async drag([x0, y0], [x1, y1], steps = 8) {
    await this.mouse('mouseMoved', x0, y0);
    await this.mouse('mousePressed', x0, y0, 'left');
    for (let i = 1; i <= steps; ++i)
      await this.mouse(
          'mouseMoved', x0 + (x1 - x0) * i / steps, y0 + (y1 - y0) * i / steps, 'left');
    await this.mouse('mouseReleased', x1, y1, 'left');
  }

  async key(key, modifiers = 0) {
    const codes = {ArrowLeft: 37, ArrowUp: 38, ArrowRight: 39, ArrowDown: 40, Tab: 9, Enter: 13};
    const text = key.length === 1 && !modifiers ? {text: key} : {};
    const event = {key, modifiers, windowsVirtualKeyCode: codes[key] || key.charCodeAt(0), ...text};
    await this.call('Input.dispatchKeyEvent', {type: 'keyDown', ...event});
    await this.call('Input.dispatchKeyEvent', {type: 'keyUp', ...event});
  }

  async screenshot(clip) {
    const {data} = await this.call(
        'Page.captureScreenshot', {format: 'png', ...(clip && {clip: {...clip, scale: 1}})});
    return Buffer.from(data, 'base64');
  }
}
