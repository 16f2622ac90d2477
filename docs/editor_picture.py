"""Make docs/editor.png: what the language server Taplo offers for a key, shown in Monaco, the editor in VS Code.

    python docs/editor_picture.py

The specification and the schema are those that `tisserand new` writes; Taplo runs in Node, and Monaco in Chromium. Both
come from npm, so that the picture is no part of `make docs`, which needs no network.
"""

from __future__ import annotations

import json
import shutil
import subprocess
import tempfile
from pathlib import Path
from typing import Any

from playwright.sync_api import sync_playwright

from derive.cli.main import main

TAPLO, MONACO = "@taplo/lsp@0.8.0", "monaco-editor@0.52.2"
HERE = Path(__file__).parent
TABLE, KEY = "[joints.shaft]", 'kind = ""'
"""The table of a joint, and its first line, between whose quotes the cursor is."""
CURSOR = KEY.index('"') + 1

PAGE = """<!DOCTYPE html><body style="margin: 0"><div id="editor" style="width: 900px; height: 420px"></div>
<script src="node_modules/monaco-editor/min/vs/loader.js"></script>
<script>
require.config({ paths: { vs: "node_modules/monaco-editor/min/vs" } });
require(["vs/editor/editor.main"], () => {
  monaco.languages.register({ id: "toml" });
  monaco.languages.setMonarchTokensProvider("toml", { tokenizer: { root: [
    [/#.*/, "comment"], [/^\\[.*\\]/, "type"], [/"[^"]*"/, "string"], [/[-+]?\\d[\\w.+-]*/, "number"],
    [/[A-Za-z_][\\w-]*(?=\\s*=)/, "attribute.name"], [/[A-Za-z_][\\w-]*/, ""] ] } });
  const suggestion = (item) => {
    const { start, end } = item.textEdit.range;
    const range = new monaco.Range(start.line + 1, start.character + 1, end.line + 1, end.character + 1);
    return { label: item.label, kind: monaco.languages.CompletionItemKind.Enum, documentation: item.documentation,
      insertText: item.textEdit.newText, sortText: item.sortText, range };
  };
  monaco.languages.registerCompletionItemProvider("toml", { provideCompletionItems: () => ({
    suggestions: given.items.map(suggestion) }) });
  const editor = monaco.editor.create(document.getElementById("editor"), { value: given.text, language: "toml",
    fontSize: 14, minimap: { enabled: false }, scrollBeyondLastLine: false, quickSuggestions: false,
    wordBasedSuggestions: "off", scrollbar: { vertical: "hidden", horizontal: "hidden" } });
  editor.setPosition({ lineNumber: given.line + 1, column: given.cursor + 1 });
  editor.setScrollTop((given.line - 6) * editor.getOption(monaco.editor.EditorOption.lineHeight));
  editor.focus();
  editor.trigger("picture", "editor.action.triggerSuggest", {});
});
</script></body>"""


def picture() -> None:
    """Write the picture."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        main(["new", "arm", "--kind", "mechanism", "--out", name])
        specification = folder / "arm.toml"
        lines = specification.read_text().splitlines()
        line = lines.index(TABLE) + 1
        lines[line] = KEY
        specification.write_text("\n".join(lines))
        subprocess.run(["npm", "install", "--silent", "--prefix", name, TAPLO, MONACO], check=True)
        place = (str(specification), str(line), str(CURSOR))
        taplo = folder / "node_modules/@taplo/lsp/dist/index.js"
        command = ["node", str(HERE / "editor_picture.cjs"), str(taplo), *place]
        items = json.loads(subprocess.run(command, check=True, capture_output=True, text=True, timeout=60).stdout)
        given = {"text": specification.read_text(), "items": items, "line": line, "cursor": CURSOR}
        _photograph(folder / "page.html", given)


def _photograph(page_file: Path, given: dict[str, Any]) -> None:
    """Show the specification and what is offered, and write the picture once both are there."""
    page_file.write_text(f"<script>const given = {json.dumps(given)};</script>{PAGE}")
    with sync_playwright() as tool:
        browser = tool.chromium.launch(executable_path=shutil.which("chromium"), args=["--no-sandbox"])
        page = browser.new_page(viewport={"width": 900, "height": 420})
        page.goto(page_file.as_uri())
        page.wait_for_selector(".suggest-widget.visible .monaco-list-row")
        page.keyboard.press("Control+Space")  # shows the explanation as well
        page.wait_for_selector(".suggest-details-container")
        page.wait_for_timeout(500)
        page.screenshot(path=HERE / "editor.png")
        browser.close()


if __name__ == "__main__":
    picture()
