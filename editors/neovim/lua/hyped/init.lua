-- Neovim and .hyped: the filetype, the language server, tree-sitter, and commands.
--
--     vim.g.hypedc_path        the hypedc executable: a command on the PATH, or a path
--     vim.g.hypedc_verdicts    false: no verdicts above goals while one types
--
-- Syntax without tree-sitter, indentation and `:make` come from the Vim files, in the folder `vim` beside this one.

local level = require('hyped.level')
local paint = require('hyped.paint')
local tags = require('hyped.tags')
local verdicts = require('hyped.verdicts')

local M = {}

local editors = vim.fs.dirname(vim.fs.dirname(vim.fs.dirname(vim.fs.dirname(vim.fs.abspath(debug.getinfo(1, 'S').source:sub(2))))))
local grammar = vim.fs.joinpath(editors, 'tree-sitter-hyped')

local function hypedc()
  return vim.g.hypedc_path or 'hypedc'
end

--- Loads the parser and its queries, if `tree-sitter build` was run in `editors/tree-sitter-hyped`.
local function tree_sitter()
  for _, name in ipairs({ 'hyped.so', 'hyped.dylib', 'hyped.dll' }) do
    local path = vim.fs.joinpath(grammar, name)
    if vim.uv.fs_stat(path) and vim.treesitter.language.add('hyped', { path = path }) then
      for _, kind in ipairs({ 'highlights', 'folds', 'indents', 'injections', 'locals' }) do
        local file = assert(io.open(vim.fs.joinpath(grammar, 'queries', kind .. '.scm')))
        vim.treesitter.query.set('hyped', kind, file:read('a'))
        file:close()
      end
      return true
    end
  end
  -- A parser that a plugin has installed.
  return pcall(vim.treesitter.language.inspect, 'hyped')
end

--- Runs hypedc in a terminal, in a new window at the bottom.
---@param arguments string[]
---@param file string
function M.run(arguments, file)
  vim.cmd('botright new')
  local command = { hypedc(), arguments[1], vim.fs.basename(file), unpack(arguments, 2) }
  return vim.fn.jobstart(command, { term = true, cwd = vim.fs.dirname(file) })
end

--- Searches for a goal of a world, or for all goals, in the buffers.
---@param file string
---@param world string?
---@param goal string?
---@param chosen table? the level of a world that leaves its map open
---@param kind string? `'never'` for a way to break one
function M.reach(file, world, goal, chosen, kind)
  require('hyped.search').reach(file, {
    world = world,
    [kind == 'never' and 'nevers' or 'goals'] = goal and { goal } or nil,
    level = chosen,
  })
end

--- Runs an input script; prompts for it if none is given.
---@param file string
---@param world string?
---@param script string?
---@param chosen table? the level of a world that leaves its map open
function M.sim(file, world, script, chosen)
  local function run(inputs)
    if inputs and inputs ~= '' then
      local arguments = vim.list_extend({ 'sim', '--inputs', inputs }, world and { '--world', world } or {})
      M.run(vim.list_extend(arguments, level.options(chosen)), file)
    end
  end
  if script then
    run(script)
  else
    vim.ui.input({ prompt = 'Inputs: ', default = '-*60' }, run)
  end
end

function M.enable()
  vim.opt.runtimepath:append(vim.fs.joinpath(editors, 'vim'))
  vim.filetype.add({ extension = { hyped = 'hyped' } })
  vim.lsp.enable('hypedc')

  -- The commands of the server's code lenses: a URI, the name of a world and, for a search, of a goal; then the level.
  vim.lsp.commands['hypedc.reach'] = function(command)
    local uri, world, goal, given, kind = unpack(command.arguments)
    local file = vim.uri_to_fname(uri)
    level.with(file, world, given, function(chosen) M.reach(file, world, goal, chosen, kind) end)
  end
  vim.lsp.commands['hypedc.sim'] = function(command)
    local uri, world, given = unpack(command.arguments)
    local file = vim.uri_to_fname(uri)
    level.with(file, world, given, function(chosen) M.sim(file, world, nil, chosen) end)
  end
  vim.lsp.commands['hypedc.play'] = function(command)
    local uri, world, _, given, inputs = unpack(command.arguments)
    local file = vim.uri_to_fname(uri)
    level.with(file, world, given, function(chosen) M.sim(file, world, inputs, chosen) end)
  end
  vim.lsp.commands['hypedc.level'] = function(command)
    local uri, world = unpack(command.arguments)
    level.choose(vim.uri_to_fname(uri), world)
  end
  verdicts.enable()
  paint.enable()
  tags.enable()

  local group = vim.api.nvim_create_augroup('hyped', {})
  vim.api.nvim_create_autocmd('FileType', {
    group = group,
    pattern = 'hyped',
    desc = 'Colours by tree-sitter, and commands',
    callback = function(event)
      if tree_sitter() then
        vim.treesitter.start(event.buf, 'hyped')
      end
      vim.api.nvim_buf_create_user_command(event.buf, 'HypedReach', function(given)
        M.reach(vim.api.nvim_buf_get_name(event.buf), nil, given.fargs[1])
      end, { nargs = '?', desc = 'Search for a goal, or for all' })
      vim.api.nvim_buf_create_user_command(event.buf, 'HypedSim', function(given)
        M.sim(vim.api.nvim_buf_get_name(event.buf), nil, given.args ~= '' and given.args or nil)
      end, { nargs = '?', desc = 'Run an input script' })
      vim.api.nvim_buf_create_user_command(event.buf, 'HypedLevel', function(given)
        level.choose(vim.api.nvim_buf_get_name(event.buf), given.args)
      end, { nargs = 1, desc = 'Choose the level of a world that leaves its map open' })
      vim.api.nvim_buf_create_user_command(event.buf, 'HypedPaint', function(given)
        paint.toggle(vim.api.nvim_buf_get_name(event.buf), given.args ~= '' and given.args or nil)
      end, { nargs = '?', desc = 'Paint the maps of a world, or take the paint away' })
      vim.api.nvim_buf_create_user_command(event.buf, 'HypedExplain', function(given)
        require('hyped.explain').show(given.fargs[1])
      end, { nargs = '?', desc = 'Show the page of a code, or of the finding at the cursor' })
      vim.api.nvim_buf_create_user_command(event.buf, 'HypedTest', function(given)
        require('hyped.tests').run(event.buf, given.args ~= '' and given.args or nil)
      end, {
        nargs = '?',
        desc = 'Run the tests of the program, or one of them',
        complete = function(start)
          return vim.tbl_filter(function(name) return vim.startswith(name, start) end, require('hyped.tests').names(event.buf))
        end,
      })
    end,
  })
  -- Levels are texts of their own: everywhere.
  vim.api.nvim_create_user_command('HypedTile', paint.tile, { desc = 'Tell of the painted tile under the cursor' })
  -- For nvim-treesitter: `:TSInstall hyped`.
  vim.api.nvim_create_autocmd('User', {
    group = group,
    pattern = 'TSUpdate',
    callback = function()
      local found, parsers = pcall(require, 'nvim-treesitter.parsers')
      if found then
        parsers.hyped = { install_info = { path = grammar, queries = 'queries' } }
      end
    end,
  })
end

return M
