!> Every key of a case file is declared once, by a line such as
!>
!>   call keys%get('restitution', settings%restitution, 'normal restitution e_n [-]', '[0.01, 1]')
!>
!> The component comes in holding the default and leaves holding what the file says. The same line checks
!> the file, is listed by --help and in doc/inputs.md, and writes the value in effect into the resolved case.
module case_keys
  use case_catalogue, only: key_t, new_key, add_key
  use case_reader, only: case_reader_t, find_entry
  use case_scanner, only: word_t
  use case_values, only: range_t, new_range, to_real, to_integer, to_logical
  use files, only: exists, folder_of
  use kinds, only: wp
  use text, only: word_length, string_t, shown, nearest_name, path_from, split
  implicit none
  private
  public :: keys_t

  !> The kind and unit of a key are those of its variable and of the bracket that ends `about`; `allowed` is
  !> an interval such as '[0, inf)' or a list of choices such as 'slip | no_slip'. A value that is not allowed
  !> leaves the default in place. `when` says in words when the key is required, `required` whether it is so here.
  type, extends(case_reader_t) :: keys_t
  contains
    procedure, private :: get_real, get_reals, get_integer, get_integers, get_logical, get_logicals, get_text
    generic :: get => get_real, get_reals, get_integer, get_integers, get_logical, get_logicals, get_text
    procedure :: get_list        !< any number of reals
    procedure :: get_id          !< the name of a record
    procedure :: get_reference   !< the name of a record of another group
    procedure :: get_references, get_optional_reference
    procedure :: get_path        !< a file or folder
    procedure, private :: declare, look_up, take_text, demand_count
  end type keys_t

contains

  subroutine get_real(self, name, value, about, allowed, required, when)
    class(keys_t), intent(inout) :: self
    character(len=*), intent(in) :: name
    real(wp), intent(inout) :: value
    character(len=*), intent(in) :: about
    character(len=*), intent(in), optional :: allowed
    logical, intent(in), optional :: required
    character(len=*), intent(in), optional :: when

    real(wp) :: values(1)

    values = value
    call self%get_reals(name, values, about, allowed, required, when)
    value = values(1)
  end subroutine get_real

  subroutine get_reals(self, name, values, about, allowed, required, when)
    class(keys_t), intent(inout) :: self
    character(len=*), intent(in) :: name
    real(wp), intent(inout) :: values(:)
    character(len=*), intent(in) :: about
    character(len=*), intent(in), optional :: allowed
    logical, intent(in), optional :: required
    character(len=*), intent(in), optional :: when

    type(word_t), allocatable :: words(:)

    call self%declare(new_key(name, plural('real', size(values)), about, shown(values), given_or(allowed), given_or(when)))
    call self%look_up(name, words, required, when)
    if (self%demand_count(name, words, size(values))) call take_reals(self, name, words, values, given_or(allowed))
    call self%echo(name, shown(values))
  end subroutine get_reals

  !> Any number of reals, at least one; not allocated if the key is not given.
  subroutine get_list(self, name, values, about, allowed, required, when)
    class(keys_t), intent(inout) :: self
    character(len=*), intent(in) :: name
    real(wp), allocatable, intent(inout) :: values(:)
    character(len=*), intent(in) :: about
    character(len=*), intent(in), optional :: allowed
    logical, intent(in), optional :: required
    character(len=*), intent(in), optional :: when

    type(word_t), allocatable :: words(:)

    call self%declare(new_key(name, 'reals', about, '', given_or(allowed), given_or(when)))
    call self%look_up(name, words, required, when)
    if (size(words) == 0) return
    allocate (values(size(words)), source=0.0_wp)
    call take_reals(self, name, words, values, given_or(allowed))
    call self%echo(name, shown(values))
  end subroutine get_list

  subroutine get_integer(self, name, value, about, allowed, required, when)
    class(keys_t), intent(inout) :: self
    character(len=*), intent(in) :: name
    integer, intent(inout) :: value
    character(len=*), intent(in) :: about
    character(len=*), intent(in), optional :: allowed
    logical, intent(in), optional :: required
    character(len=*), intent(in), optional :: when

    integer :: values(1)

    values = value
    call self%get_integers(name, values, about, allowed, required, when)
    value = values(1)
  end subroutine get_integer

  !> A default outside the allowed range means: none.
  subroutine get_integers(self, name, values, about, allowed, required, when)
    class(keys_t), intent(inout) :: self
    character(len=*), intent(in) :: name
    integer, intent(inout) :: values(:)
    character(len=*), intent(in) :: about
    character(len=*), intent(in), optional :: allowed
    logical, intent(in), optional :: required
    character(len=*), intent(in), optional :: when

    type(word_t), allocatable :: words(:)
    type(range_t) :: range
    character(len=:), allocatable :: message, default
    integer :: i, read(size(values))
    logical :: ok

    range = new_range(given_or(allowed))
    default = shown(values)
    if (.not. all(range%has(real(values, wp)))) default = ''
    call self%declare(new_key(name, plural('integer', size(values)), about, default, given_or(allowed), given_or(when)))
    call self%look_up(name, words, required, when)
    if (self%demand_count(name, words, size(values))) then
      ok = .true.
      do i = 1, size(words)
        call to_integer(words(i), read(i), message)
        if (len(message) == 0 .and. .not. range%has(real(read(i), wp))) message = range%demand()
        call self%require(len(message) == 0, name, message)
        ok = ok .and. len(message) == 0
      end do
      if (ok) values = read
    end if
    if (all(range%has(real(values, wp)))) call self%echo(name, shown(values))
  end subroutine get_integers

  subroutine get_logical(self, name, value, about)
    class(keys_t), intent(inout) :: self
    character(len=*), intent(in) :: name
    logical, intent(inout) :: value
    character(len=*), intent(in) :: about

    logical :: values(1)

    values = value
    call self%get_logicals(name, values, about)
    value = values(1)
  end subroutine get_logical

  subroutine get_logicals(self, name, values, about)
    class(keys_t), intent(inout) :: self
    character(len=*), intent(in) :: name
    logical, intent(inout) :: values(:)
    character(len=*), intent(in) :: about

    type(word_t), allocatable :: words(:)
    character(len=:), allocatable :: message
    integer :: i

    call self%declare(new_key(name, plural('logical', size(values)), about, shown(values), 'true | false', ''))
    call self%look_up(name, words)
    if (self%demand_count(name, words, size(values))) then
      do i = 1, size(words)
        call to_logical(words(i), values(i), message)
        call self%require(len(message) == 0, name, message)
      end do
    end if
    call self%echo(name, shown(values))
  end subroutine get_logicals

  !> A text, or one of the choices of `allowed`.
  subroutine get_text(self, name, value, about, allowed, required, when)
    class(keys_t), intent(inout) :: self
    character(len=*), intent(in) :: name
    ! allow(C072)
    character(len=*), intent(inout) :: value  !< a text that is longer is reported
    character(len=*), intent(in) :: about
    character(len=*), intent(in), optional :: allowed
    logical, intent(in), optional :: required
    character(len=*), intent(in), optional :: when

    type(string_t), allocatable :: choices(:)
    character(len=len(value)) :: read
    character(len=:), allocatable :: kind, message
    integer :: best, i

    kind = 'text'
    if (.not. present(allowed)) kind = 'text of at most '//shown(len(value))//' characters'
    call self%declare(new_key(name, kind, about, shown(value), given_or(allowed), given_or(when)))
    read = value
    call self%take_text(name, read, required, when)
    choices = split(given_or(allowed), '|')
    if (self%given(name) .and. size(choices) > 0) then
      if (.not. any([(choices(i)%text == read, i=1, size(choices))])) then
        best = nearest_name(trim(read), choices)
        message = 'must be one of '//given_or(allowed)
        if (best > 0) message = message//'; did you mean '//choices(best)%text//'?'
        if (len_trim(read) > 0) call self%require(.false., name, message)
        read = value
      end if
    end if
    value = read
    call self%echo(name, shown(value))
  end subroutine get_text

  !> The name of a record, by which others refer to it; no two of a group have the same.
  subroutine get_id(self, value, about)
    class(keys_t), intent(inout) :: self
    character(len=word_length), intent(inout) :: value
    character(len=*), intent(in) :: about

    integer :: first

    call self%get('id', value, about, required=.true., when='always')
    if (self%record == 0 .or. len_trim(value) == 0) return
    associate (group => self%groups(self%home)%name)
      first = self%file%find(group, self%file%find_id(group, trim(value)))
    end associate
    if (first == 0) return  ! given twice, with different values
    call self%require(first == self%record, 'id', 'is the id of another record, at '//self%file%records(first)%place)
    call self%require(verify(trim(value), '0123456789') > 0, 'id', 'must not be a number')
  end subroutine get_id

  !> The id of a record of another group, and which one that is.
  subroutine get_reference(self, name, id, place, group, required, when)
    class(keys_t), intent(inout) :: self
    character(len=*), intent(in) :: name
    character(len=word_length), intent(inout) :: id
    integer, intent(out) :: place                 !< counted within the group; 0 if there is no such record
    character(len=*), intent(in) :: group
    logical, intent(in) :: required
    character(len=*), intent(in) :: when

    call self%get(name, id, 'id of a &'//group//' record', required=required, when=when)
    call find_reference(self, name, group, trim(id), place)
  end subroutine get_reference

  !> The same of a record that need not be named; place is 0 then, too.
  subroutine get_optional_reference(self, name, id, place, group, about)
    class(keys_t), intent(inout) :: self
    character(len=*), intent(in) :: name
    character(len=word_length), intent(inout) :: id
    integer, intent(out) :: place
    character(len=*), intent(in) :: group, about

    call self%get(name, id, about)
    call find_reference(self, name, group, trim(id), place)
  end subroutine get_optional_reference

  !> As many ids of records of another group as there is room for, always required, and which ones these are.
  subroutine get_references(self, name, ids, places, group)
    class(keys_t), intent(inout) :: self
    character(len=*), intent(in) :: name
    character(len=word_length), intent(inout) :: ids(:)
    integer, intent(out) :: places(size(ids))     !< counted within the group; 0 if there is no such record
    character(len=*), intent(in) :: group

    type(word_t), allocatable :: words(:)
    integer :: i
    logical :: bare

    places = 0
    call self%declare(new_key(name, plural('text', size(ids)), 'ids of &'//group//' records', '', '', 'always'))
    call self%look_up(name, words, .true., 'always')
    if (.not. self%demand_count(name, words, size(ids))) return
    associate (entries => self%file%records(self%record)%entries)
      bare = allocated(entries(find_entry(entries, name))%whole)  ! from a command line, which eats quotes
    end associate
    do i = 1, size(ids)
      call self%require(bare .or. words(i)%is_text, name, "must be texts in quotes: '"//words(i)%text//"'")
      ids(i) = words(i)%text
      call find_reference(self, name, group, words(i)%text, places(i))
    end do
    call self%echo(name, shown(ids))
  end subroutine get_references

  !> The place of a record of an id, if one is given: 0 and a mistake, which names one that is similar, if there is none.
  subroutine find_reference(keys, name, group, id, place)
    type(keys_t), intent(inout) :: keys
    character(len=*), intent(in) :: name, group, id
    integer, intent(out) :: place

    type(string_t), allocatable :: ids(:)
    character(len=:), allocatable :: message
    integer :: i, best

    place = keys%file%find_id(group, id)
    if (place > 0 .or. len(id) == 0) return
    allocate (ids(keys%file%count(group)))
    do i = 1, size(ids)
      ids(i)%text = keys%file%id(keys%file%find(group, i))
    end do
    best = nearest_name(id, ids)
    message = 'there is no &'//group//" of id '"//id//"'"
    if (best > 0) message = message//"; did you mean '"//ids(best)%text//"'?"
    call keys%require(.false., name, message)
  end subroutine find_reference

  !> A file or folder, relative to the file in which the key stands; on return, relative to where the program
  !> was started.
  subroutine get_path(self, name, value, about, must_exist)
    class(keys_t), intent(inout) :: self
    character(len=*), intent(in) :: name
    ! allow(C072)
    character(len=*), intent(inout) :: value  !< a text that is longer is reported
    character(len=*), intent(in) :: about
    logical, intent(in) :: must_exist

    character(len=:), allocatable :: base, path

    call self%declare(new_key(name, 'text of at most '//shown(len(value))//' characters', about, shown(value), '', ''))
    call self%take_text(name, value)
    if (self%listing .or. len_trim(value) == 0) return
    base = self%file%path
    if (self%given(name)) then
      associate (entries => self%file%records(self%record)%entries)
        base = entries(find_entry(entries, name))%place
      end associate
    end if
    path = path_from(folder_of(base), value)
    call self%require(len(path) <= len(value), name, 'has more than '//shown(len(value))//' characters with its folder')
    value = path
    if (must_exist) call self%require(exists(path), name, "there is no file '"//path//"'")
    call self%echo(name, shown(value))
  end subroutine get_path

  !> Put a key on the list of all keys.
  subroutine declare(self, key)
    class(keys_t), intent(inout) :: self
    type(key_t), intent(in) :: key

    if (self%listing) call add_key(self%groups(self%home)%keys, key)
  end subroutine declare

  !> What the open record says of a key: no words if nothing.
  subroutine look_up(self, name, words, required, when)
    class(keys_t), intent(inout) :: self
    character(len=*), intent(in) :: name
    type(word_t), allocatable, intent(inout) :: words(:)
    logical, intent(in), optional :: required
    character(len=*), intent(in), optional :: when

    character(len=:), allocatable :: message

    if (self%given(name)) then
      associate (entries => self%file%records(self%record)%entries)
        words = entries(find_entry(entries, name))%values
      end associate
      call self%require(size(words) > 0, name, 'a value is missing')
    else
      allocate (words(0))
      if (.not. present(required)) return
      message = 'is missing; it is required '//given_or(when)
      if (given_or(when) == 'always') message = 'is missing'
      call self%require(.not. required, name, message)
    end if
  end subroutine look_up

  !> The text of a key as far as it is one and fits.
  subroutine take_text(self, name, value, required, when)
    class(keys_t), intent(inout) :: self
    character(len=*), intent(in) :: name
    ! allow(C072)
    character(len=*), intent(inout) :: value  !< a text that is longer is reported
    logical, intent(in), optional :: required
    character(len=*), intent(in), optional :: when

    type(word_t), allocatable :: words(:)
    integer :: k

    call self%look_up(name, words, required, when)
    if (size(words) == 0) return
    associate (entries => self%file%records(self%record)%entries)
      k = find_entry(entries, name)
      if (allocated(entries(k)%whole)) then
        words = words(:1)
        words(1)%text = entries(k)%whole
        words(1)%is_text = .true.
      end if
    end associate
    if (.not. self%demand_count(name, words, 1)) return
    if (.not. words(1)%is_text) then
      call self%require(.false., name, "must be a text in quotes: '"//words(1)%text//"'")
    else if (len(words(1)%text) > len(value)) then
      call self%require(.false., name, 'has '//shown(len(words(1)%text))//' characters; at most ' &
                        //shown(len(value))//' are kept')
    else
      call self%require(len_trim(words(1)%text) > 0, name, 'must not be empty')
      value = words(1)%text
    end if
  end subroutine take_text

  !> Whether a key has as many values as it needs; a key that is not given has none.
  function demand_count(self, name, words, n) result(ok)
    class(keys_t), intent(inout) :: self
    character(len=*), intent(in) :: name
    type(word_t), intent(in) :: words(:)
    integer, intent(in) :: n
    logical :: ok

    ok = size(words) == n
    if (size(words) == 0 .or. ok) return
    call self%require(.false., name, 'must have '//shown(n)//', not '//shown(size(words))//' values')
  end function demand_count

  !> Words as numbers in a range; on any mistake the values stay as they are.
  subroutine take_reals(keys, name, words, values, allowed)
    type(keys_t), intent(inout) :: keys
    character(len=*), intent(in) :: name
    type(word_t), intent(in) :: words(:)
    real(wp), intent(inout) :: values(:)
    character(len=*), intent(in) :: allowed

    type(range_t) :: range
    character(len=:), allocatable :: message
    real(wp) :: read(size(values))
    integer :: i

    range = new_range(allowed)
    do i = 1, size(words)
      call to_real(words(i), read(i), message)
      if (len(message) == 0 .and. .not. range%has(read(i))) message = range%demand()
      call keys%require(len(message) == 0, name, message)
      if (len(message) > 0) return
    end do
    values = read
  end subroutine take_reals

  !> '3 reals', 'real'.
  pure function plural(word, n) result(words)
    character(len=*), intent(in) :: word
    integer, intent(in) :: n
    character(len=:), allocatable :: words

    words = word
    if (n > 1) words = shown(n)//' '//word//'s'
  end function plural

  pure function given_or(argument) result(text)
    character(len=*), intent(in), optional :: argument
    character(len=:), allocatable :: text  !< nothing if the argument is absent

    text = ''
    if (present(argument)) text = argument
  end function given_or

end module case_keys
