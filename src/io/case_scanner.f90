!> Cuts the text of a case file into records, keys and values, and knows the line of each.
!>
!>   &group key = value, value key = 'text' ! a comment
!>   /
!>
!> Between records anything may stand, as long as it does not look like a key with a value.
module case_scanner
  use problems, only: problems_t
  use text, only: shown, lower_case
  implicit none
  private
  public :: record_t, entry_t, word_t, scan_case, scan_values, append

  type :: word_t
    character(len=:), allocatable :: text  !< without its quotes
    logical :: is_text = .false.           !< whether it had quotes
  end type word_t

  !> key = values
  type :: entry_t
    character(len=:), allocatable :: key
    character(len=:), allocatable :: place       !< file:line
    integer :: line = 0                          !< of the key
    integer :: beside = 0                        !< how many of the values stand on that line
    character(len=:), allocatable :: whole       !< all the values as one text, for an entry not from a file
    type(word_t), allocatable :: values(:)
  end type entry_t

  !> &group entries /
  type :: record_t
    character(len=:), allocatable :: group
    character(len=:), allocatable :: place       !< file:line
    type(entry_t), allocatable :: entries(:)
  end type record_t

  interface append
    module procedure append_word, append_entry, append_record
  end interface append

  character(len=*), parameter :: line_end = achar(10)
  character(len=*), parameter :: blanks = ' '//achar(9)//achar(13)
  character(len=*), parameter :: letters = 'abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ'
  character(len=*), parameter :: digits = '0123456789'
  character(len=*), parameter :: enders = blanks//line_end//",/!=&'"//'"'  !< no bare word contains these

  !> A place in the text.
  type :: cursor_t
    character(len=:), allocatable :: file
    integer :: at = 1         !< the next character
    integer :: line = 1       !< and its line
    integer :: closed = 0     !< line on which the last record ended
  end type cursor_t

contains

  !> All records of a text, in order; what cannot be read is added to the problems.
  subroutine scan_case(text, file, records, problems)
    character(len=*), intent(in) :: text
    character(len=*), intent(in) :: file                      !< name to blame
    type(record_t), allocatable, intent(inout) :: records(:)  !< the new ones are put at the end
    type(problems_t), intent(inout) :: problems

    type(cursor_t) :: cursor
    type(record_t) :: record

    cursor%file = file
    if (index(text, char(239)//char(187)//char(191)) == 1) cursor%at = 4  ! the mark of UTF-8
    do while (cursor%at <= len(text))
      call skip(text, cursor, blanks)
      if (next(text, cursor) == '&') then
        call scan_record(text, cursor, record, problems)
        if (len(record%group) > 0) call append(records, record)
      else
        call pass_free_text(text, cursor, problems)
      end if
    end do
  end subroutine scan_case

  !> The values in a piece of text that holds nothing else.
  subroutine scan_values(text, values)
    character(len=*), intent(in) :: text
    type(word_t), allocatable, intent(out) :: values(:)

    type(cursor_t) :: cursor
    type(problems_t) :: ignored
    type(word_t) :: word

    cursor%file = ''
    allocate (values(0))
    do
      call skip(text, cursor, blanks//line_end//',')
      if (cursor%at > len(text)) exit
      call scan_word(text, cursor, word, ignored)
      if (len(word%text) == 0 .and. .not. word%is_text) word%text = next(text, cursor)
      if (len(word%text) == 1 .and. scan(word%text, enders) == 1) cursor%at = cursor%at + 1
      call append_repeated(values, word)
    end do
  end subroutine scan_values

  !> From an ampersand to the slash that belongs to it.
  subroutine scan_record(text, cursor, record, problems)
    character(len=*), intent(in) :: text
    type(cursor_t), intent(inout) :: cursor
    type(record_t), intent(out) :: record
    type(problems_t), intent(inout) :: problems

    integer :: first
    type(cursor_t) :: start

    record%place = here(cursor)
    allocate (record%entries(0))
    first = cursor%at + 1
    cursor%at = first
    call skip(text, cursor, letters//digits//'_')
    record%group = lower_case(text(first:cursor%at - 1))
    if (len(record%group) == 0) then
      call problems%add(record%place//': an & begins a record and must be followed by the name of a group')
      return
    end if
    do
      call skip_to_word(text, cursor)
      start = cursor
      select case (next(text, cursor))
      case ('/')
        cursor%at = cursor%at + 1
        cursor%closed = cursor%line
        return
      case ('', '&')
        call problems%add(record%place//': &'//record%group//" has no closing '/'")
        call drop_what_followed(record)
        return
      case ('=')
        call problems%add(here(cursor)//': &'//record%group//': a key is missing before =')
        cursor%at = cursor%at + 1
      case default
        call scan_item(text, cursor, record, problems)
      end select
      if (cursor%at == start%at) error stop 'case_scanner: no progress'
    end do
  end subroutine scan_record

  !> A key, or one more value of the last key.
  subroutine scan_item(text, cursor, record, problems)
    character(len=*), intent(in) :: text
    type(cursor_t), intent(inout) :: cursor
    type(record_t), intent(inout) :: record
    type(problems_t), intent(inout) :: problems

    type(word_t) :: word
    type(entry_t) :: entry
    character(len=:), allocatable :: place
    integer :: n

    place = here(cursor)
    call scan_word(text, cursor, word, problems)
    call skip(text, cursor, blanks)
    n = size(record%entries)
    if (next(text, cursor) == '=' .and. .not. word%is_text) then
      cursor%at = cursor%at + 1
      entry%key = lower_case(word%text)
      entry%place = place
      entry%line = cursor%line
      allocate (entry%values(0))
      call append(record%entries, entry)
    else if (n == 0) then
      call problems%add(place//': &'//record%group//': '//word%text//' belongs to no key')
    else
      associate (last => record%entries(n))
        call append_repeated(last%values, word)
        if (last%line == cursor%line) last%beside = size(last%values)
      end associate
    end if
  end subroutine scan_item

  !> A text in quotes, or whatever else stands between blanks and commas.
  subroutine scan_word(text, cursor, word, problems)
    character(len=*), intent(in) :: text
    type(cursor_t), intent(inout) :: cursor
    type(word_t), intent(out) :: word
    type(problems_t), intent(inout) :: problems

    character(len=1) :: quote
    integer :: length

    quote = next(text, cursor)
    word%is_text = quote == "'" .or. quote == '"'
    word%text = ''
    if (.not. word%is_text) then
      length = scan(text(cursor%at:), enders) - 1
      if (length < 0) length = len(text) - cursor%at + 1
      word%text = text(cursor%at:cursor%at + length - 1)
      cursor%at = cursor%at + length
      return
    end if
    do
      cursor%at = cursor%at + 1
      length = scan(text(cursor%at:), quote//line_end//achar(13)) - 1
      if (length < 0) length = len(text) - cursor%at + 1
      word%text = word%text//text(cursor%at:cursor%at + length - 1)
      cursor%at = cursor%at + length
      if (next(text, cursor) /= quote) then
        call problems%add(here(cursor)//': '//quote//word%text//': the closing '//quote//' is missing')
        word%text = word%text(:scan(word%text//',', ',') - 1)  ! as if it stood before the first comma
        return
      end if
      cursor%at = cursor%at + 1
      if (next(text, cursor) /= quote) return
      word%text = word%text//quote  ! a doubled quote stands for one
    end do
  end subroutine scan_word

  !> Over blanks, commas, comments and line ends, which are counted.
  subroutine skip_to_word(text, cursor)
    character(len=*), intent(in) :: text
    type(cursor_t), intent(inout) :: cursor

    do
      call skip(text, cursor, blanks//',')
      select case (next(text, cursor))
      case ('!')
        call to_line_end(text, cursor)
      case (line_end)
        cursor%at = cursor%at + 1
        cursor%line = cursor%line + 1
      case default
        return
      end select
    end do
  end subroutine skip_to_word

  !> Over the rest of a line outside all records. A line that looks like a key, or like the second half of
  !> a fraction whose / has closed the record, was not meant as free text.
  subroutine pass_free_text(text, cursor, problems)
    character(len=*), intent(in) :: text
    type(cursor_t), intent(inout) :: cursor
    type(problems_t), intent(inout) :: problems

    integer :: first
    character(len=:), allocatable :: line

    first = cursor%at
    call to_line_end(text, cursor)
    line = text(first:cursor%at - 1)
    if (len(line) > 0) then
      first = verify(line, letters//digits//'_%()')
      if (first > 1) first = first - 1 + verify(line(first:), blanks)
      if (first > 1) then
        call problems%require(line(first:first) /= '=', here(cursor)//': '//trimmed(line)// &
                              ' stands outside all records (a / ends a record, an & begins one)')
      end if
      call problems%require(.not. (cursor%closed == cursor%line .and. scan(line(1:1), digits//'+-.') == 1), &
                            here(cursor)//': '//trimmed(line)//' follows the / that ended the record')
    end if
    cursor%at = cursor%at + 1
    cursor%line = cursor%line + 1
  end subroutine pass_free_text

  subroutine to_line_end(text, cursor)
    character(len=*), intent(in) :: text
    type(cursor_t), intent(inout) :: cursor

    integer :: length

    length = index(text(cursor%at:), line_end) - 1
    if (length < 0) length = len(text) - cursor%at + 1
    cursor%at = cursor%at + length
  end subroutine to_line_end

  !> Over any of these characters.
  subroutine skip(text, cursor, characters)
    character(len=*), intent(in) :: text, characters
    type(cursor_t), intent(inout) :: cursor

    integer :: length

    if (cursor%at > len(text)) return
    length = verify(text(cursor%at:), characters) - 1
    if (length < 0) length = len(text) - cursor%at + 1
    cursor%at = cursor%at + length
  end subroutine skip

  !> The next character, nothing at the end.
  pure function next(text, cursor)
    character(len=*), intent(in) :: text
    type(cursor_t), intent(in) :: cursor
    character(len=:), allocatable :: next

    next = ''
    if (cursor%at <= len(text)) next = text(cursor%at:cursor%at)
  end function next

  pure function here(cursor)
    type(cursor_t), intent(in) :: cursor
    character(len=:), allocatable :: here

    here = cursor%file//':'//shown(cursor%line)
  end function here

  pure function trimmed(line)
    character(len=*), intent(in) :: line
    character(len=:), allocatable :: trimmed

    integer :: last

    last = verify(line, blanks, back=.true.)
    trimmed = line(:last)
  end function trimmed

  !> Free text after a record that was never closed looks like values of its last key: keep those beside the key.
  pure subroutine drop_what_followed(record)
    type(record_t), intent(inout) :: record

    integer :: n

    n = size(record%entries)
    if (n > 0) record%entries(n)%values = record%entries(n)%values(:record%entries(n)%beside)
  end subroutine drop_what_followed

  !> Append a value, as often as it says: 3*0.5 is 0.5, 0.5, 0.5.
  subroutine append_repeated(values, word)
    type(word_t), allocatable, intent(inout) :: values(:)
    type(word_t), intent(in) :: word

    integer :: star, times, i
    type(word_t) :: value

    star = index(word%text, '*')
    value = word
    times = 1
    if (star > 1 .and. star < 5 .and. .not. word%is_text) then
      if (verify(word%text(:star - 1), digits) == 0) then
        read (word%text(:star - 1), *) times
        value%text = word%text(star + 1:)
      end if
    end if
    do i = 1, times
      call append(values, value)
    end do
  end subroutine append_repeated

  subroutine append_word(list, item)
    type(word_t), allocatable, intent(inout) :: list(:)
    type(word_t), intent(in) :: item

    type(word_t), allocatable :: longer(:)

    allocate (longer(size(list) + 1))
    longer(:size(list)) = list
    longer(size(longer)) = item
    call move_alloc(longer, list)
  end subroutine append_word

  subroutine append_entry(list, item)
    type(entry_t), allocatable, intent(inout) :: list(:)
    type(entry_t), intent(in) :: item

    type(entry_t), allocatable :: longer(:)

    allocate (longer(size(list) + 1))
    longer(:size(list)) = list
    longer(size(longer)) = item
    call move_alloc(longer, list)
  end subroutine append_entry

  subroutine append_record(list, item)
    type(record_t), allocatable, intent(inout) :: list(:)
    type(record_t), intent(in) :: item

    type(record_t), allocatable :: longer(:)

    allocate (longer(size(list) + 1))
    longer(:size(list)) = list
    longer(size(longer)) = item
    call move_alloc(longer, list)
  end subroutine append_record

end module case_scanner
