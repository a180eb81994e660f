#!/usr/bin/env python3
"""check_language.py [PATH...]: finds phrases that are not plain American English.

Checks Markdown, and comments and messages in code; by default all files.
Exits with 1 if there are findings."""
import pathlib, re, subprocess, sys

BRITISH = r"""recognis normalis standardis minimis maximis optimis initialis summaris quantis localis generalis organis
serialis synchronis colour grey behaviour centre neighbour metre labell travell modell cancelled catalogue licence
judgement towards whilst analyse artefact""".split()

RULES = {
    r'(?<!\w)[A-Za-z]*(%s)[a-z]*(?!\w)' % '|'.join(BRITISH): 'American spelling',
    r'\bper cent\b': 'percent or %',
    r'(?<!here )\b(is|are|was|were|be) no (?!longer\b|more\b|less\b|nearer\b)[a-z]+': 'is not a',
    r'\bso (many|much|few|long|often) (?!that\b|as\b)[a-z]+': 'N, or name the quantity',
    r'\b(numbers?|bits?|bytes?|frames?|lines?|rows?|words?|calls?|values?|deviations?|entry|entries|one|ms|meters?|operations?) '
    r'an? (frame|line|row|nat|second|window|sequence|query|view|place|file|pixel|call|hour|step|cell)\b': 'per',
    r'(^|[.;:] )Of (?!course)[a-z]+': 'do not begin with Of',
    r'\b(of|by|from|to|with|than|for|as|on|at) what\b': 'name the thing',
    r'(^|[.] )(What|Whoever|Who) (is|was|are|were|has|says|an?|the|it|wants|stands|walks)\b(?!.*\?)': 'name the thing',
    r'\bwhole numbers?\b': 'integer',
    r'\b(anew|oftener|lately|nowise|no[b]ody|maybe|mend(ed|s)|be[s]ide|in a row)\b': 'unidiomatic',
    r', too\b(?=[.,;:)]|$)': 'also, as well',
    r'\bmay not be\b': 'must not be, or is possibly not',
    r'\bsuch an? \w+': 'this, or name it',
    r'\bthat of\b': 'repeat the noun',
    r'\bNothing (if|where|unless)\b': 'nullopt, null or empty',
    r'\b(leaves?|leaving|left) out\b': 'omit',
    r'[;:.] give |\bgive --': 'pass or use',
    r'\b(believ(e|es|ed)|look(s|ed) at|asked for)\b': 'programs confirm, read, request',
    r'\bstandardi[sz]ed scores?\b': 'z-scores',
    r'\bpictures?\b': 'image',
    r'\bwere (its|their|the|these) \w+ not\b': 'if it were not',
    r'\bmay give (less|more)\b': 'expect lower or higher numbers',
    r'\bthe most of all\b': 'the highest count',
    r'^- \*[\w ]+\*: (need|depend|err|confirm|follow|cost)s?\b': 'a sentence with a subject',
    r'(?<=[.] )So (?!that\b|far\b)': 'join the sentences with so, because or but',
    r'\b(until (lately|now)|of older date|used to be)\b': 'docs state the present',
    r'\bNext: vpr-': 'next: vpr-',
}
# Legitimate uses: part of the path, part of the line.
ALLOWED = [('check_language', ''), ('scripts/reproduce/paper/', '')]
SUFFIXES = {'.md', '.json', '.h', '.cpp', '.py', '.sh', '.js', '.cmake', '.txt'}


def prose(path):
    """Line numbers and text: whole lines of Markdown, comments and strings with blanks of code."""
    comment = r'//[/<]* ?(.*)$' if path.suffix in {'.h', '.cpp', '.js'} else r'(?:^|\s)#+ ?(.*)$'
    docstring = False
    for number, line in enumerate(path.read_text(encoding='utf-8').split('\n'), 1):
        if path.suffix == '.md':
            yield number, line
            continue
        if path.suffix == '.py' and (docstring or '"""' in line):
            docstring ^= line.count('"""') == 1
            yield number, line.replace('"""', '').strip()
            continue
        for string in re.findall(r'"((?:[^"\\]|\\.)*)"', line):
            if ' ' in string.strip():
                yield number, string
        for text in re.findall(comment, re.sub(r'"(?:[^"\\]|\\.)*"', '""', line)):
            yield number, text


def main():
    roots = sys.argv[1:] or ['.']
    names = subprocess.run(['git', 'ls-files', '--', *roots], capture_output=True, text=True, check=True).stdout
    paths = [path for path in map(pathlib.Path, names.splitlines()) if path.suffix in SUFFIXES and path.is_file()]
    bad = 0
    for path, (number, text) in ((path, line) for path in paths for line in prose(path)):
        if any(part in str(path) and use in text for part, use in ALLOWED):
            continue
        for rule, advice in RULES.items():
            for found in re.finditer(rule, text):
                bad = 1
                print(f'{path}:{number}: {found[0].strip()} ({advice})')
    return bad


sys.exit(main())
