!> Goes through the groups of a case file as they are declared, and blames mistakes on the right line.
module case_reader
  use case_catalogue, only: group_t, add_group, find_group, find_key, names_of
  use case_file, only: case_file_t
  use case_scanner, only: entry_t
  use case_values, only: as_written
  use problems, only: problems_t
  use text, only: nearest_name
  implicit none
  private
  public :: case_reader_t, find_entry

  character(len=*), parameter :: next_line = new_line('a')

  type :: case_reader_t
    type(case_file_t) :: file
    type(problems_t) :: problems
    type(group_t), allocatable :: groups(:)       !< all groups and their keys
    character(len=:), allocatable :: resolved     !< the case with all values in effect, as a case file
    logical :: listing = .false.                  !< only list what may be declared, read nothing
    integer :: home = 0                           !< the open group: its place in `groups`
    integer :: record = 0                         !< the open record: its place in file%records, 0 if not given
    logical :: silent = .false.                   !< the open group has no part in this case
    logical, private :: unfinished = .false.      !< the last record of `resolved` has no end yet
  contains
    procedure :: list
    procedure :: begin
    procedure :: finish
    procedure :: has_group
    procedure :: group
    procedure :: number
    procedure :: open
    procedure :: given
    procedure :: require
    procedure :: require_at
    procedure :: echo
    procedure, private :: check_names, advice
  end type case_reader_t

contains

  !> Collect what can be declared: no file is read.
  subroutine list(self)
    class(case_reader_t), intent(inout) :: self

    self%listing = .true.
    self%resolved = ''
    self%file%path = ''
    allocate (self%file%records(0), self%groups(0))
  end subroutine list

  !> Start reading a file whose groups and keys are known from a listing. A group that is misspelt is
  !> reported and then read as the nearest, so that its values are checked in the same run.
  subroutine begin(self, file, groups, problems)
    class(case_reader_t), intent(inout) :: self
    type(case_file_t), intent(in) :: file
    type(group_t), intent(in) :: groups(:)
    type(problems_t), intent(in) :: problems  !< found so far

    character(len=:), allocatable :: message
    integer :: i, best

    self%file = file
    self%groups = groups
    self%problems = problems
    self%resolved = ''
    do i = 1, size(file%records)
      associate (record => self%file%records(i))
        if (find_group(groups, record%group) > 0) cycle
        message = record%place//': &'//record%group//': there is no such group; '
        best = nearest_name(record%group, names_of(groups))
        if (best == 0) then
          call self%problems%add(message//'see --help')
          cycle
        end if
        call self%problems%add(message//'did you mean &'//groups(best)%name//'?')
        if (groups(best)%repeated .or. file%count(groups(best)%name) == 0) record%group = groups(best)%name
      end associate
    end do
  end subroutine begin

  !> All groups have been declared.
  subroutine finish(self)
    class(case_reader_t), intent(inout) :: self

    if (self%unfinished) self%resolved = self%resolved//'/'//next_line
    self%unfinished = .false.
  end subroutine finish

  !> Whether the file has a record of this group.
  pure function has_group(self, name)
    class(case_reader_t), intent(in) :: self
    character(len=*), intent(in) :: name
    logical :: has_group

    has_group = self%file%count(name) > 0
  end function has_group

  !> Declare a group; the keys declared next belong to it.
  subroutine group(self, name, about, when, required, unwanted, repeated)
    class(case_reader_t), intent(inout) :: self
    character(len=*), intent(in) :: name
    character(len=*), intent(in) :: about
    character(len=*), intent(in) :: when                 !< when the group is required or used, in words
    logical, intent(in), optional :: required, unwanted  !< whether it is so in this case
    logical, intent(in), optional :: repeated            !< whether there may be several records

    logical :: several
    integer :: n

    several = .false.
    if (present(repeated)) several = repeated
    if (self%listing) call add_group(self%groups, name, about, when, several)
    self%home = find_group(self%groups, name)
    self%silent = .false.
    if (present(unwanted)) self%silent = unwanted
    n = self%file%count(name)
    if (present(required)) call self%problems%require(n > 0 .or. self%listing .or. .not. required, &
                                                      self%file%path//': &'//name//' is missing; '//when)
    call self%require_at(n == 0 .or. .not. self%silent, name, 1, '', 'does not belong here; '//when)
    if (several) return
    if (n > 1) call self%require_at(.false., name, 2, '', 'is given twice, first at ' &
                                    //self%file%records(self%file%find(name, 1))%place)
    call self%open(1)
  end subroutine group

  !> How many records the group has.
  pure function number(self)
    class(case_reader_t), intent(in) :: self
    integer :: number

    number = self%file%count(self%groups(self%home)%name)
    if (self%listing) number = 1
  end function number

  !> Turn to the i-th record of the group, whose keys come next.
  subroutine open(self, i)
    class(case_reader_t), intent(inout) :: self
    integer, intent(in) :: i

    call self%finish()
    associate (name => self%groups(self%home)%name)
      self%record = self%file%find(name, i)
      self%unfinished = .not. self%silent
      if (self%unfinished) self%resolved = self%resolved//'&'//name//next_line
    end associate
    if (self%record > 0) call self%check_names()
  end subroutine open

  !> Repeated and unknown keys of the open record. A misspelt key is read as the nearest, too.
  subroutine check_names(self)
    class(case_reader_t), intent(inout) :: self

    integer :: k, best

    associate (entries => self%file%records(self%record)%entries, keys => self%groups(self%home)%keys)
      do k = 1, size(entries)
        if (find_entry(entries(:k - 1), entries(k)%key) > 0) then
          call self%require(.false., entries(k)%key, 'is given twice', entries(k))
        else if (find_key(keys, entries(k)%key) == 0) then
          best = nearest_name(entries(k)%key, names_of(keys))
          call self%require(.false., entries(k)%key, 'there is no such key'//self%advice(entries(k)%key, best), entries(k))
          if (best == 0) cycle
          if (find_entry(entries, keys(best)%name) == 0) entries(k)%key = keys(best)%name
        end if
      end do
    end associate
  end subroutine check_names

  !> What was probably meant by a key that the open group does not have.
  pure function advice(self, key, best) result(text)
    class(case_reader_t), intent(in) :: self
    character(len=*), intent(in) :: key
    integer, intent(in) :: best  !< the nearest key of the group, 0 if none is near
    character(len=:), allocatable :: text

    integer :: i

    text = '; see --help '//self%groups(self%home)%name
    do i = 1, size(self%groups)
      if (find_key(self%groups(i)%keys, key) > 0) text = ' here, but in &'//self%groups(i)%name
    end do
    if (best > 0) text = '; did you mean '//self%groups(self%home)%keys(best)%name//'?'
  end function advice

  !> Whether the open record has a key.
  pure function given(self, key)
    class(case_reader_t), intent(in) :: self
    character(len=*), intent(in) :: key
    logical :: given

    given = .false.
    if (self%record > 0) given = find_entry(self%file%records(self%record)%entries, key) > 0
  end function given

  !> Note a mistake in a key of the open record unless `ok`.
  subroutine require(self, ok, key, message, entry)
    class(case_reader_t), intent(inout) :: self
    logical, intent(in) :: ok
    character(len=*), intent(in) :: key, message
    type(entry_t), intent(in), optional :: entry  !< where the key has several

    if (ok .or. self%record == 0) return
    call self%problems%add(blame(self, self%record, key, message, entry))
  end subroutine require

  !> Note a mistake in a key of the i-th record of a group, given or not, unless `ok`.
  subroutine require_at(self, ok, group, i, key, message)
    class(case_reader_t), intent(inout) :: self
    logical, intent(in) :: ok
    character(len=*), intent(in) :: group
    integer, intent(in) :: i
    character(len=*), intent(in) :: key      !< nothing: the record as a whole
    character(len=*), intent(in) :: message

    integer :: record

    if (ok) return
    record = self%file%find(group, i)
    if (record > 0) then
      call self%problems%add(blame(self, record, key, message))
    else
      call self%problems%add(self%file%path//': '//trim('&'//group//' '//key)//': '//message)
    end if
  end subroutine require_at

  !> 'bed.nml:12: &fill(bed) mass = 0.3 kg: message'
  pure function blame(self, record, key, message, entry) result(line)
    class(case_reader_t), intent(in) :: self
    integer, intent(in) :: record
    character(len=*), intent(in) :: key, message
    type(entry_t), intent(in), optional :: entry
    character(len=:), allocatable :: line

    character(len=:), allocatable :: place, words
    integer :: k

    associate (found => self%file%records(record))
      place = found%place
      words = self%file%label(found%group, record)
      if (len(key) > 0) words = words//' '//key
      k = find_entry(found%entries, key)
      if (present(entry)) then
        place = entry%place
        words = trim(words//' = '//as_written(entry%values))
      else if (k > 0) then
        place = found%entries(k)%place
        words = trim(words//' = '//as_written(found%entries(k)%values))
        if (size(found%entries(k)%values) > 0) words = words//unit_of(self%groups, found%group, key)
      end if
    end associate
    line = place//': '//words//': '//message
  end function blame

  !> The unit of a key, with a blank before it.
  pure function unit_of(groups, group, key) result(unit)
    type(group_t), intent(in) :: groups(:)
    character(len=*), intent(in) :: group, key
    character(len=:), allocatable :: unit

    integer :: home, k

    unit = ''
    home = find_group(groups, group)
    if (home == 0) return
    k = find_key(groups(home)%keys, key)
    if (k == 0) return
    unit = groups(home)%keys(k)%unit()
    if (len(unit) > 0) unit = ' '//unit
  end function unit_of

  !> A value in effect, for the resolved case.
  subroutine echo(self, key, value)
    class(case_reader_t), intent(inout) :: self
    character(len=*), intent(in) :: key, value

    if (self%silent .or. len(value) == 0) return
    self%resolved = self%resolved//'  '//key//' = '//value//next_line
  end subroutine echo

  !> Place of a key among entries, 0 if it is not there.
  pure function find_entry(entries, key) result(i)
    type(entry_t), intent(in) :: entries(:)
    character(len=*), intent(in) :: key
    integer :: i

    do i = size(entries), 1, -1
      if (entries(i)%key == key) return
    end do
  end function find_entry

end module case_reader
