// Runs a program for wasm32-wasip1 in node, with its words and environment: `node .ci/wasi.mjs PROGRAM.wasm [WORD ..]`.
// The program sees the folder it is started in, and those around it as `..`, `../..` and so on.

import { readFile } from "node:fs/promises";
import { WASI } from "node:wasi";

const [file, ...words] = process.argv.slice(2);
const preopens = Object.fromEntries([".", "..", "../.."].map((folder) => [folder, folder]));
const wasi = new WASI({ version: "preview1", args: [file, ...words], env: process.env, preopens });
const module = await WebAssembly.compile(await readFile(file));

// Debian's wasi-libc lacks the functions of threads, which Rust's library names: they refuse to start any.
const TRY_AGAIN = 6;
const env = {};
for (const { module: from, name } of WebAssembly.Module.imports(module)) {
    if (from === "env") {
        env[name] = () => (name === "pthread_create" ? TRY_AGAIN : 0);
    }
}
process.exitCode = wasi.start(await WebAssembly.instantiate(module, { ...wasi.getImportObject(), env }));
