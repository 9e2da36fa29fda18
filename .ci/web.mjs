// Opens the pages of a site in Chromium, as a visitor with a mouse and one with a phone would, and fails at the first error:
// `node .ci/web.mjs SITE PICTURES HASH`. Makes a picture of each page.

import { readFile, mkdir } from 'node:fs/promises';
import { createServer } from 'node:http';
import { createRequire } from 'node:module';
import { extname, join, normalize } from 'node:path';
import { gzipSync } from 'node:zlib';

const [site, pictures, golden] = process.argv.slice(2);
const { chromium } = createRequire(join(process.env.TOOLS, 'package.json'))('playwright-core');

const TYPES = {
    '.css': 'text/css', '.glb': 'model/gltf-binary', '.html': 'text/html', '.js': 'text/javascript', '.png': 'image/png', '.svg': 'image/svg+xml',
    '.wasm': 'application/wasm', '.webp': 'image/webp',
};
// Chromium without a graphics card.
const SOFTWARE = ['--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--ignore-gpu-blocklist'];
const DESKTOP = { viewport: { width: 1280, height: 720 } };
// As small as can be looked at: there are many examples to draw.
const SMALL = { viewport: { width: 480, height: 360 } };
const PHONE = { viewport: { width: 390, height: 844 }, deviceScaleFactor: 2, hasTouch: true, isMobile: true };
// Milliseconds that software may take to draw, and to simulate the demo.
const PATIENCE = 600_000;
// Frames after which an example has what it loads, and moves.
const FRAMES = 6;
// Folder of the site on its server, as on GitHub Pages: no address may be absolute.
const FOLDER = '/bevy_drape/';

// Serves the site as a static host does, compressed.
async function serve() {
    const compressed = new Map();
    const server = createServer(async (request, response) => {
        const path = normalize(decodeURIComponent(new URL(request.url, 'http://host').pathname));
        try {
            if (!path.startsWith(FOLDER)) {
                throw new Error('outside');
            }
            if (!compressed.has(path)) {
                compressed.set(path, gzipSync(await readFile(join(site, path.slice(FOLDER.length) || 'index.html'))));
            }
            const type = TYPES[extname(path) || '.html'] ?? 'application/octet-stream';
            response.writeHead(200, { 'content-type': type, 'content-encoding': 'gzip' }).end(compressed.get(path));
        } catch {
            response.writeHead(404).end();
        }
    });
    await new Promise((resolve) => server.listen(0, '127.0.0.1', resolve));
    return server;
}

function check(holds, fault) {
    if (!holds) {
        throw new Error(fault);
    }
}

// A browser for this device. A page that counts pixels of the screen does not see those of a device that is only pretended.
function launch(device) {
    const args = [...SOFTWARE, `--force-device-scale-factor=${device.deviceScaleFactor ?? 1}`];
    return chromium.launch({ executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium', args });
}

// A page of the site, watched: errors and requests for permissions end up in its list of faults.
async function open(device, address) {
    const browser = await launch(device);
    const context = await browser.newContext(device);
    await context.addInitScript(() => {
        window.asked = [];
        for (const name of ['AudioContext', 'webkitAudioContext']) {
            window[name] = class {
                constructor() {
                    window.asked.push(name);
                }
            };
        }
        for (const [owner, name] of [[navigator.mediaDevices, 'getUserMedia'], [window.Notification, 'requestPermission']]) {
            if (owner) {
                owner[name] = () => window.asked.push(name);
            }
        }
    });
    const page = await context.newPage();
    const faults = [];
    page.on('console', (message) => message.type() === 'error' && faults.push(message.text()));
    page.on('pageerror', (error) => faults.push(String(error)));
    page.on('requestfailed', (request) => faults.push(`${request.url()}: ${request.failure()?.errorText}`));
    page.setDefaultTimeout(PATIENCE);
    await page.goto(address);
    return { browser, context, page, faults };
}

async function close({ browser, page, faults }) {
    const asked = await page.evaluate(() => window.asked);
    check(asked.length === 0, `the page asks for ${asked}`);
    check(faults.length === 0, faults.join('\n'));
    await browser.close();
}

// Waits until nothing is missing in the picture.
async function drawn({ page, faults }) {
    await page.waitForFunction(() => document.documentElement.hasAttribute('data-drawn') || document.querySelector('progress').hidden);
    check(faults.length === 0, faults.join('\n'));
    check(await page.evaluate(() => document.documentElement.hasAttribute('data-drawn')), await page.textContent('#message'));
    return page.textContent('#first-picture');
}

async function fits(page) {
    const over = await page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
    check(over <= 0, `the page is ${over} pixels too wide`);
}

async function picture(page, name) {
    await page.screenshot({ path: join(pictures, `${name}.png`) });
}

function frames(page, count) {
    return page.evaluate(async (count) => {
        for (; count > 0; count -= 1) {
            await new Promise(requestAnimationFrame);
        }
    }, count);
}

async function shots(page, count) {
    await page.waitForFunction((count) => document.querySelector('#shots').textContent === String(count), count);
}

// A click and a tap each fire one shot.
async function cannon(root, device, name) {
    const opened = await open(device, `${root}cannon.html`);
    const { page } = opened;
    console.log(`cannon, ${name}: first picture after ${await drawn(opened)} s`);
    await fits(page);
    await picture(page, `cannon_${name}`);
    const { width } = device.viewport;
    await (device.hasTouch ? page.touchscreen.tap(width - 40, 160) : page.mouse.click(width - 60, 160));
    await shots(page, 1);
    await page.waitForTimeout(3000);
    await picture(page, `cannon_${name}_shot`);
    await close(opened);
}

// The planned shots end in the same bits as on any other machine.
async function planned(root) {
    const opened = await open(SMALL, `${root}cannon.html?shots=5`);
    const { page } = opened;
    await drawn(opened);
    await page.waitForFunction(() => document.querySelector('#state-hash').textContent !== '-');
    await shots(page, 5);
    const hash = await page.textContent('#state-hash');
    check(hash === golden, `the demo ends in ${hash}, not in ${golden}`);
    console.log(`cannon, five shots: state hash ${hash}`);
    await picture(page, 'cannon_end');
    await close(opened);
}

// Every example of the showcase begins.
async function showcase(root, device, name, of) {
    const opened = await open(device, `${root}showcase.html`);
    const { page, faults } = opened;
    console.log(`showcase, ${name}: first picture after ${await drawn(opened)} s`);
    await fits(page);
    const examples = await page.$$eval('#example option', (options) => options.map((option) => option.value));
    for (const example of of ?? examples) {
        await page.selectOption('#example', example);
        await page.waitForFunction((example) => document.documentElement.dataset.example === example, example);
        await frames(page, FRAMES);
        check(faults.length === 0, `${example}: ${faults.join('\n')}`);
        await picture(page, `showcase_${name}_${example}`);
    }
    await close(opened);
    return examples;
}

// The overview names all examples, and no link of the site is dead.
async function overview(root, examples) {
    for (const [name, device] of [['desktop', DESKTOP], ['phone', PHONE]]) {
        const opened = await open(device, root);
        const { page } = opened;
        await fits(page);
        await picture(page, `index_${name}`);
        const links = await page.$$eval('a, img', (all) => all.map((one) => one.href ?? one.src));
        for (const link of links.filter((link) => link.startsWith(root))) {
            check((await fetch(link)).ok, `${link} is dead`);
        }
        const named = links.map((link) => new URL(link).hash.slice(1)).filter((name) => name !== '');
        check(String(named) === String(examples), `the overview names ${named}, the showcase ${examples}`);
        await close(opened);
    }
}

await mkdir(pictures, { recursive: true });
const server = await serve();
const root = `http://127.0.0.1:${server.address().port}${FOLDER}`;
try {
    await cannon(root, DESKTOP, 'desktop');
    await cannon(root, PHONE, 'phone');
    await planned(root);
    const examples = await showcase(root, SMALL, 'small');
    await showcase(root, DESKTOP, 'desktop', ['flag', 'cape_gltf']);
    await showcase(root, PHONE, 'phone', ['flag', 'drape']);
    await overview(root, examples);
    console.log(`${examples.length + 1} programs and pages without an error`);
} finally {
    server.close();
}
