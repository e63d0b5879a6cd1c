// What the pages' scripts must keep to: no unused name, no undeclared one, and logic that no browser is needed for.

import js from "@eslint/js";
import globals from "globals";

const STATIC = "service/safestart_service/static";

export default [
  { ignores: [".venv/", "node_modules/", "test-artifacts/"] },
  js.configs.recommended,
  {
    linterOptions: { reportUnusedDisableDirectives: "error" },
    rules: {
      "array-callback-return": "error",
      "consistent-return": "error",
      "eqeqeq": "error",
      "no-else-return": "error",
      "no-implicit-coercion": "error",
      "no-self-compare": "error",
      "no-shadow": "error",
      "no-unused-vars": ["error", { caughtErrors: "all" }],
      "no-use-before-define": ["error", { functions: false, variables: false }],
      "no-useless-return": "error",
      "no-var": "error",
      "object-shorthand": "error",
      "prefer-const": "error",
      "require-atomic-updates": "error",
    },
  },
  {
    files: [`${STATIC}/pages/*.js`, `${STATIC}/parts/*.js`],
    languageOptions: { globals: { ...globals.browser, Plotly: "readonly" } },
  },
  {
    // Logic runs in node's tests as it runs in the page: of the platform it has what both have.
    files: [`${STATIC}/logic/*.js`],
    languageOptions: { globals: globals["shared-node-browser"] },
    rules: {
      "no-restricted-imports": ["error", { patterns: [{ group: ["../*"], message: "logic knows neither pages nor parts" }] }],
    },
  },
  { files: ["tests/browser/*.js"], languageOptions: { globals: globals.browser } },
  { files: ["tests/javascript/*.js", "tests/clients/programs/*.mjs", "*.js"], languageOptions: { globals: globals.nodeBuiltin } },
];
