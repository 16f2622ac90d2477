// Print what Taplo's language server offers at a place of a TOML file, as JSON:
//     node editor_picture.cjs index.js-of-@taplo/lsp FILE LINE CHARACTER
const fs = require("fs");
const path = require("path");

const [module_, file, line, character] = process.argv.slice(2);
const { TaploLsp } = require(module_);
const folder = path.dirname(file);
const root = { uri: `file://${folder}`, name: "folder" };
const textDocument = { uri: `file://${file}` };

const environment = {
  now: () => new Date(),
  envVar: () => "",
  envVars: () => [],
  stdErrAtty: () => false,
  stdin: async () => new Uint8Array(),
  stdout: async (data) => data.length,
  stderr: async (data) => data.length,
  glob: () => [],
  readFile: async (name) => new Uint8Array(fs.readFileSync(name)),
  writeFile: async () => {},
  urlToFilePath: (url) => decodeURIComponent(url.replace("file://", "")),
  isAbsolute: (name) => name.startsWith("/"),
  cwd: () => folder,
  findConfigFile: () => undefined,
};

async function main() {
  const waiting = {};
  const onMessage = (message) => {
    if (message.id === undefined) return;
    if (message.method) server.send({ jsonrpc: "2.0", id: message.id, result: [null] }); // it asks for settings
    else waiting[message.id](message.result);
  };
  const server = await TaploLsp.initialize(environment, { onMessage });
  let last = 0;
  const tell = (method, params) => server.send({ jsonrpc: "2.0", method, params });
  const ask = (method, params) =>
    new Promise((answered) => {
      const id = ++last;
      waiting[id] = answered;
      server.send({ jsonrpc: "2.0", id, method, params });
    });
  await ask("initialize", { processId: null, rootUri: root.uri, capabilities: {}, workspaceFolders: [root] });
  tell("initialized", {});
  const text = fs.readFileSync(file, "utf8");
  tell("textDocument/didOpen", { textDocument: { ...textDocument, languageId: "toml", version: 1, text } });
  for (;;) {
    // It reads the schema meanwhile, and offers nothing before.
    const found = await ask("textDocument/completion", { textDocument, position: { line: +line, character: +character } });
    const items = found?.items ?? found ?? [];
    if (items.length) {
      console.log(JSON.stringify(items));
      process.exit(0);
    }
    await new Promise((done) => setTimeout(done, 200));
  }
}

main();
