!> All groups and keys a case file may have, and how they are shown to a user.
module case_catalogue
  use text, only: string_t, nearest_name
  implicit none
  private
  public :: key_t, group_t, new_key, add_key, add_group, find_group, find_key, names_of, print_group_help, write_markdown

  type :: key_t
    character(len=:), allocatable :: name
    character(len=:), allocatable :: kind       !< 'real', '3 integers', 'text' ...
    character(len=:), allocatable :: about      !< what it means, and its unit: 'density of the gas [kg/m3]'
    character(len=:), allocatable :: default    !< nothing if it has none
    character(len=:), allocatable :: allowed    !< '(0, 1]' or 'a | b'; nothing: anything
    character(len=:), allocatable :: when       !< when it is required, in words; nothing: never
  contains
    procedure :: meaning
    procedure :: unit
  end type key_t

  type :: group_t
    character(len=:), allocatable :: name
    character(len=:), allocatable :: about
    character(len=:), allocatable :: when       !< when it is required or used, in words
    logical :: repeated = .false.               !< whether there may be several records
    type(key_t), allocatable :: keys(:)
  end type group_t

  interface names_of
    module procedure names_of_groups, names_of_keys
  end interface names_of

contains

  pure function new_key(name, kind, about, default, allowed, when) result(key)
    character(len=*), intent(in) :: name, kind, about, default, allowed, when  !< see key_t
    type(key_t) :: key

    key%name = name
    key%kind = kind
    key%about = about
    key%default = default
    key%allowed = allowed
    key%when = when
  end function new_key

  subroutine add_group(groups, name, about, when, repeated)
    type(group_t), allocatable, intent(inout) :: groups(:)
    character(len=*), intent(in) :: name, about, when
    logical, intent(in) :: repeated

    type(group_t), allocatable :: longer(:)
    integer :: n

    n = size(groups)
    allocate (longer(n + 1))
    longer(:n) = groups
    longer(n + 1)%name = name
    longer(n + 1)%about = about
    longer(n + 1)%when = when
    longer(n + 1)%repeated = repeated
    allocate (longer(n + 1)%keys(0))
    call move_alloc(longer, groups)
  end subroutine add_group

  subroutine add_key(keys, key)
    type(key_t), allocatable, intent(inout) :: keys(:)
    type(key_t), intent(in) :: key

    type(key_t), allocatable :: longer(:)

    allocate (longer(size(keys) + 1))
    longer(:size(keys)) = keys
    longer(size(longer)) = key
    call move_alloc(longer, keys)
  end subroutine add_key

  pure function find_group(groups, name) result(i)
    type(group_t), intent(in) :: groups(:)
    character(len=*), intent(in) :: name
    integer :: i  !< 0 if there is none

    do i = size(groups), 1, -1
      if (groups(i)%name == name) return
    end do
  end function find_group

  pure function find_key(keys, name) result(i)
    type(key_t), intent(in) :: keys(:)
    character(len=*), intent(in) :: name
    integer :: i  !< 0 if there is none

    do i = size(keys), 1, -1
      if (keys(i)%name == name) return
    end do
  end function find_key

  pure function names_of_groups(groups) result(names)
    type(group_t), intent(in) :: groups(:)
    type(string_t) :: names(size(groups))

    integer :: i

    do i = 1, size(groups)
      names(i)%text = groups(i)%name
    end do
  end function names_of_groups

  pure function names_of_keys(keys) result(names)
    type(key_t), intent(in) :: keys(:)
    type(string_t) :: names(size(keys))

    integer :: i

    do i = 1, size(keys)
      names(i)%text = keys(i)%name
    end do
  end function names_of_keys

  !> `about` without its unit.
  pure function meaning(self)
    class(key_t), intent(in) :: self
    character(len=:), allocatable :: meaning

    integer :: bracket

    bracket = index(self%about, ' [', back=.true.)
    meaning = self%about
    if (bracket > 0) meaning = self%about(:bracket - 1)
  end function meaning

  !> The unit at the end of `about`; nothing for texts and for numbers without one.
  pure function unit(self)
    class(key_t), intent(in) :: self
    character(len=:), allocatable :: unit

    integer :: bracket

    bracket = index(self%about, ' [', back=.true.)
    unit = ''
    if (bracket > 0) unit = self%about(bracket + 2:len(self%about) - 1)
    if (unit == '-') unit = ''
  end function unit

  !> All groups, or all keys of one.
  subroutine print_group_help(groups, name, unit)
    type(group_t), intent(in) :: groups(:)
    character(len=*), intent(in) :: name  !< nothing: the list of groups
    integer, intent(in) :: unit

    integer :: i, home

    home = find_group(groups, name)
    if (home == 0) then
      if (len(name) > 0) then
        home = nearest_name(name, names_of(groups))
        if (home == 0) write (unit, '(3a)') 'There is no group &', name, '.'
        if (home > 0) write (unit, '(5a)') 'There is no group &', name, '; did you mean &', groups(home)%name, '?'
      end if
      write (unit, '(a)') 'Groups of a case file:'
      do i = 1, size(groups)
        write (unit, '(2x,a,t19,3a)') '&'//groups(i)%name, groups(i)%about, several(groups(i)), '; '//groups(i)%when
      end do
      write (unit, '(2x,a,t19,a)') '&include', "file = 'NAME': the records of another file; NAME is relative to this one"
      write (unit, '(a)') 'geldart --help GROUP lists the keys of a group.'
      return
    end if
    write (unit, '(5a)') '&', name, ': ', groups(home)%about, several(groups(home))//'; '//groups(home)%when
    do i = 1, size(groups(home)%keys)
      associate (key => groups(home)%keys(i))
        write (unit, '(2x,a,t30,a)') key%name, key%about
        write (unit, '(t30,a)') details(key)
      end associate
    end do
  end subroutine print_group_help

  pure function several(group)
    type(group_t), intent(in) :: group
    character(len=:), allocatable :: several

    several = ''
    if (group%repeated) several = ' (any number of records)'
  end function several

  !> Type, range, default and necessity of a key in one line.
  pure function details(key)
    type(key_t), intent(in) :: key
    character(len=:), allocatable :: details

    details = key%kind
    if (len(key%allowed) > 0) details = details//', '//key%allowed
    if (len(key%default) > 0) details = details//', default '//key%default
    if (len(key%when) > 0) details = details//', required '//key%when
  end function details

  !> The reference of the case file: one table per group.
  subroutine write_markdown(groups, unit)
    type(group_t), intent(in) :: groups(:)
    integer, intent(in) :: unit

    integer :: i, k

    call write_preamble(unit)
    do i = 1, size(groups)
      write (unit, '(/,3a,/)') '## `&', groups(i)%name, '`'
      write (unit, '(5a,/)') upper_first(groups(i)%about), several(groups(i)), '; ', groups(i)%when, '.'
      write (unit, '(a)') '| key | meaning | type | unit | default | allowed |', '|---|---|---|---|---|---|'
      do k = 1, size(groups(i)%keys)
        associate (key => groups(i)%keys(k))
          write (unit, '(20a)') '| `', key%name, '` | ', key%meaning(), ' | ', key%kind, ' | ', key%unit(), ' | ', &
            default_cell(key), ' | ', table_safe(key%allowed), ' |'
        end associate
      end do
    end do
  end subroutine write_markdown

  subroutine write_preamble(unit)
    integer, intent(in) :: unit

    write (unit, '(a)') '# Inputs', &
      '', &
      'Every group and key of a case file, as `geldart --markdown` writes them. All quantities are in SI units.', &
      '`geldart --help GROUP` shows the same on the screen, and `geldart CASE.nml --check` what a case implies.', &
      '', &
      '```', &
      '&group key = value, key = 1, 2, 3, key = ''text''   ! a comment', &
      '/', &
      'Anything else between records is a comment, too.', &
      '&include file = ''other.nml'' /', &
      '```', &
      '', &
      '* Texts stand in single or double quotes. Logicals are `true`, `false`, `t`, `f`, with or without points.', &
      '  `3*0.5` is `0.5, 0.5, 0.5`. Groups and keys may be in upper or lower case; ids and texts are as they are.', &
      '* Where there may be several records, each has an `id`, and other records refer to it.', &
      '* Included files and files of parcels are sought relative to the file that names them.', &
      '* `--set group%key=value` replaces what the file says, or adds to it; `--set ''group(id)%key=value''` where a', &
      '  group has several records. The text needs no quotes there.', &
      '* Boxes are given by their lowest and highest corner.', &
      '* All mistakes of a case are reported at once, each with its line, and nothing is computed or written.'
  end subroutine write_preamble

  !> What stands in the column of defaults.
  pure function default_cell(key) result(cell)
    type(key_t), intent(in) :: key
    character(len=:), allocatable :: cell

    cell = ''
    if (len(key%default) > 0) cell = '`'//key%default//'`'
    if (len(key%default) > 0 .and. len(key%when) > 0) cell = cell//', '
    if (len(key%when) > 0) cell = cell//'required '//key%when
  end function default_cell

  !> A bar would end a cell of a table; choices are set apart by commas instead.
  pure function table_safe(text) result(cell)
    character(len=*), intent(in) :: text
    character(len=:), allocatable :: cell

    integer :: i

    cell = ''
    if (len(text) == 0) return
    cell = '`'
    i = 1
    do while (i <= len(text))
      if (text(i:min(i + 2, len(text))) == ' | ') then
        cell = cell//'`, `'
        i = i + 3
      else
        cell = cell//text(i:i)
        i = i + 1
      end if
    end do
    cell = cell//'`'
  end function table_safe

  pure function upper_first(words) result(sentence)
    character(len=*), intent(in) :: words
    character(len=len(words)) :: sentence

    sentence = words
    if (words(1:1) >= 'a' .and. words(1:1) <= 'z') sentence(1:1) = achar(iachar(words(1:1)) - 32)
  end function upper_first

end module case_catalogue
