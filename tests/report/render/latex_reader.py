"""A strict reader of LaTeX: it knows all commands a report may use, and where they may stand."""

from __future__ import annotations

import re

ARTICLE = """documentclass usepackage hypersetup allowdisplaybreaks setlength emergencystretch newcommand newenvironment
title author date maketitle section subsection paragraph label caption hyperref href texttt textbf textit
textrm noindent codeline phantomsection quad begingroup endgroup small scriptsize footnotesize tiny large
par medskip raggedright itshape centering fbox parbox linewidth addtocounter tabcolsep toprule midrule
bottomrule endfirsthead endhead endlastfoot tabularnewline hangindent hangafter makebox hspace textbackslash
textasciitilde textasciicircum textless textgreater textbar dots S begin end"""
MATH = """boldsymbol mathbf mathrm mathit text frac sqrt dot ddot dddot cdot times pm int sum prod partial leq geq neq
approx equiv to in left right vert colon notag tag quad sin cos tan exp operatorname label begin end alpha
beta gamma delta varepsilon zeta eta theta iota kappa lambda mu nu xi pi rho sigma tau upsilon varphi phi
chi psi omega varGamma varDelta varTheta varLambda varXi varPi varSigma varUpsilon varPhi varPsi varOmega
Gamma Delta Theta Lambda Xi Pi Sigma Phi Psi Omega leftarrow surd infty circ Vert neg vdots dots langle
rangle otimes"""
ALIGNED = {"align", "array", "longtable"}
TOKEN = re.compile(r"\\[A-Za-z]+\*?|\\.|[{}$&_^#%~]|[^\\{}$&_^#%~]+", re.S)


def faults(text: str) -> list[str]:
    """The faults of an article in LaTeX."""
    found: list[str] = []
    text = re.sub(r"(?m)^%.*$", "", text)
    head, body = text.split("\\begin{document}", 1)
    found += [f"not of ASCII: {c}" for c in sorted(set(text)) if not c.isascii()]
    labels = re.findall(r"\\label\{([^}]*)\}", body)
    found += [f"label {one} comes twice" for one in set(labels) if labels.count(one) > 1]
    found += [f"no label {one}" for one in re.findall(r"\\hyperref\[([^]]*)\]", body) if one not in labels]
    packages = re.findall(r"\\usepackage(?:\[[^]]*\])?\{([^}]*)\}", head)
    found += [f"package {one}" for one in packages if one not in ("amsmath", "longtable", "booktabs", "hyperref")]
    return found + _body(re.sub(r"(?<!\\)\\(hyperref|parbox|makebox|begin\{figure\})\[[^]]*\]", r"\\\1", body))


def _body(text: str) -> list[str]:
    """Braces, environments, dollars, and the commands of each mode, which a stack keeps."""
    found: list[str] = []
    stack: list[tuple[str, bool]] = [("document", False)]
    fences, tokens, k = 0, TOKEN.findall(text), 0
    pending_text = False
    while k < len(tokens):
        token = tokens[k]
        math = stack[-1][1] if stack else False
        if token in ("\\begin", "\\end"):
            name = tokens[k + 2]
            k += 3
            if token == "\\begin":
                stack.append((name, math or name == "align"))
            elif not stack or stack.pop()[0] != name:
                found.append(f"\\end{{{name}}}")
        elif token == "{":
            stack.append(("{", math and not pending_text))
        elif token == "}":
            found += [] if stack.pop()[0] == "{" else ["}"]
        elif token == "$":
            if stack[-1][0] == "$":
                stack.pop()
            else:
                found += ["$ within math"] if math else []
                stack.append(("$", True))
        elif token == "&":
            found += [] if stack[-1][0] in ALIGNED else ["& outside of a table"]
        elif token in ("_", "^"):
            found += [] if math else [f"{token} outside of math"]
        elif token in ("#", "%"):
            found.append(f"{token} by itself")
        elif re.fullmatch(r"\\[A-Za-z]+\*?", token):
            known = (MATH if math else ARTICLE).split()
            found += [] if token[1:].rstrip("*") in known or token in ("\\ss", "\\o") else [f"{token}, math: {math}"]
            fences += {"\\left": 1, "\\right": -1}.get(token, 0)
            found += ["\\right before \\left"] if fences < 0 else []
        if token in ("\\text", "\\tag", "\\tag*", "\\label", "\\texttt"):
            pending_text = True
        elif token.strip():
            pending_text = False
        k += 1
    found += ["\\left without \\right"] if fences else []
    return found + [f"{name} is open" for name, _ in stack]
