-- A stand-in for what the adapter uses of neotest and nvim-nio, where these are not installed: tasks as coroutines, and
-- trees of positions.

local nio = { control = {}, fn = vim.fn }

--- Suspends the running task until `start` calls the function that it is given.
local function await(start)
  local task = assert(coroutine.running(), 'not in a task')
  local came, values, is_waiting = false, nil, false
  start(function(...)
    came, values = true, { ... }
    if is_waiting then
      assert(coroutine.resume(task))
    end
  end)
  if not came then
    is_waiting = true
    coroutine.yield()
  end
  return unpack(values)
end

function nio.run(body, done)
  coroutine.resume(coroutine.create(function()
    local all = { xpcall(body, debug.traceback) }
    if done then
      done(unpack(all))
    else
      assert(unpack(all))
    end
  end))
end

function nio.sleep(time)
  await(function(resume) vim.defer_fn(resume, time) end)
end

function nio.scheduler()
  await(vim.schedule)
end

function nio.control.future()
  local future, waiting, value, is_set = {}, {}, nil, false
  function future.set(given)
    value, is_set = given, true
    for _, resume in ipairs(waiting) do
      resume(given)
    end
  end
  function future.is_set()
    return is_set
  end
  function future.wait()
    if is_set then
      return value
    end
    return await(function(resume) waiting[#waiting + 1] = resume end)
  end
  return future
end

function nio.control.queue()
  local queue = {}
  return {
    put_nowait = function(value) queue[#queue + 1] = value end,
    get = function() return table.remove(queue, 1) end,
  }
end

local Tree = {}
Tree.__index = Tree

function Tree.from_list(list, key)
  local data, children = list, {}
  if vim.islist(list) then
    data = list[1]
    for index = 2, #list do
      children[#children + 1] = Tree.from_list(list[index], key)
    end
  end
  return setmetatable({ position = data, inner = children, key = key }, Tree)
end

function Tree:data()
  return self.position
end

function Tree:children()
  return self.inner
end

function Tree:iter()
  local all = {}
  local function collect(tree)
    all[#all + 1] = tree.position
    vim.tbl_map(collect, tree.inner)
  end
  collect(self)
  return ipairs(all)
end

function Tree:get_key(id)
  if self.key(self.position) == id then
    return self
  end
  for _, child in ipairs(self.inner) do
    local found = child:get_key(id)
    if found then
      return found
    end
  end
end

package.loaded['nio'] = nio
package.loaded['neotest.types'] = { Tree = Tree }
