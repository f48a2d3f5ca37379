!> Small work on characters: numbers as text, case, nearest names, paths.
module text
  use constants, only: is_set
  use kinds, only: wp, i8
  implicit none
  private
  public :: brief, word_length, line_length, string_t, shown, quoted, lower_case, split, nearest_name, starts_with, &
    path_from

  integer, parameter :: word_length = 32   !< longest id, name or choice in a case file
  integer, parameter :: line_length = 256  !< longest title or file name in a case file

  !> One of many texts of different lengths.
  type :: string_t
    character(len=:), allocatable :: text
  end type string_t

  !> A value, or several, as a case file would have them; nothing where a number is unset or a text blank.
  interface shown
    module procedure shown_real, shown_integer, shown_long, shown_logical, shown_text
    module procedure shown_reals, shown_integers, shown_logicals, shown_texts
  end interface shown

contains

  !> The fewest digits that read back as exactly x; nothing where x is unset.
  pure function shown_real(x) result(text)
    real(wp), intent(in) :: x
    character(len=:), allocatable :: text

    character(len=32) :: buffer, form
    real(wp) :: back
    integer :: digits

    text = ''
    if (.not. is_set(x)) return
    ! Rounding up one of the largest numbers would overflow.
    do digits = merge(17, 1, abs(x) > 1.0e300_wp), 17
      write (form, '(a,i0,a)') '(es32.', digits - 1, 'e3)'
      write (buffer, form) x
      read (buffer, *) back
      if (.not. (back < x .or. back > x)) exit
    end do
    text = plain(trim(adjustl(buffer)))
  end function shown_real

  !> A number for the eye: four figures.
  pure function brief(x) result(words)
    real(wp), intent(in) :: x
    character(len=:), allocatable :: words

    character(len=16) :: buffer
    real(wp) :: rounded

    write (buffer, '(es12.3)') x
    read (buffer, *) rounded
    words = shown_real(rounded)
  end function brief

  !> '1.25E-003' as 0.00125, but very large and very small numbers as 1.25e-7.
  pure function plain(scientific) result(text)
    character(len=*), intent(in) :: scientific
    character(len=:), allocatable :: text

    character(len=:), allocatable :: digits, sign
    integer :: mark, exponent

    text = scientific
    mark = scan(scientific, 'E')
    if (mark == 0) return
    sign = ''
    digits = scientific(:mark - 1)
    if (digits(1:1) == '-') sign = '-'
    digits = digits(len(sign) + 1:)
    read (scientific(mark + 1:), *) exponent
    if (exponent < -3 .or. exponent > 6) then
      if (digits(len(digits):) == '.') digits = digits(:len(digits) - 1)
      text = sign//digits//'e'//shown_integer(exponent)
      return
    end if
    digits = digits(1:1)//digits(3:)
    if (exponent < 0) then
      text = sign//'0.'//repeat('0', -exponent - 1)//digits
    else if (exponent >= len(digits) - 1) then
      text = sign//digits//repeat('0', exponent - len(digits) + 1)
    else
      text = sign//digits(:exponent + 1)//'.'//digits(exponent + 2:)
    end if
  end function plain

  pure function shown_integer(n) result(text)
    integer, intent(in) :: n
    character(len=:), allocatable :: text

    text = shown_long(int(n, i8))
  end function shown_integer

  pure function shown_long(n) result(text)
    integer(i8), intent(in) :: n
    character(len=:), allocatable :: text

    character(len=24) :: buffer

    write (buffer, '(i0)') n
    text = trim(buffer)
  end function shown_long

  pure function shown_logical(flag) result(text)
    logical, intent(in) :: flag
    character(len=:), allocatable :: text

    text = trim(merge('true ', 'false', flag))
  end function shown_logical

  pure function shown_text(words) result(text)
    character(len=*), intent(in) :: words
    character(len=:), allocatable :: text

    text = ''
    if (len_trim(words) > 0) text = quoted(words)
  end function shown_text

  pure function shown_texts(words) result(text)
    character(len=*), intent(in) :: words(:)
    character(len=:), allocatable :: text

    integer :: i

    text = ''
    do i = 1, size(words)
      text = listed(text, shown_text(words(i)))
    end do
  end function shown_texts

  pure function shown_reals(x) result(text)
    real(wp), intent(in) :: x(:)
    character(len=:), allocatable :: text

    integer :: i

    text = ''
    if (.not. all(is_set(x))) return
    do i = 1, size(x)
      text = listed(text, shown_real(x(i)))
    end do
  end function shown_reals

  pure function shown_integers(n) result(text)
    integer, intent(in) :: n(:)
    character(len=:), allocatable :: text

    integer :: i

    text = ''
    do i = 1, size(n)
      text = listed(text, shown_integer(n(i)))
    end do
  end function shown_integers

  pure function shown_logicals(flag) result(text)
    logical, intent(in) :: flag(:)
    character(len=:), allocatable :: text

    integer :: i

    text = ''
    do i = 1, size(flag)
      text = listed(text, shown_logical(flag(i)))
    end do
  end function shown_logicals

  !> One more item behind a comma.
  pure function listed(text, item) result(longer)
    character(len=*), intent(in) :: text, item
    character(len=:), allocatable :: longer

    longer = item
    if (len(text) > 0) longer = text//', '//item
  end function listed

  !> The pieces between the marks, without blanks around them; none of an empty text.
  pure function split(text, mark) result(pieces)
    character(len=*), intent(in) :: text
    character(len=1), intent(in) :: mark
    type(string_t), allocatable :: pieces(:)

    integer :: i, first, length

    if (len_trim(text) == 0) then
      allocate (pieces(0))
      return
    end if
    allocate (pieces(1 + count([(text(i:i) == mark, i=1, len(text))])))
    first = 1
    do i = 1, size(pieces)
      length = index(text(first:), mark) - 1
      if (length < 0) length = len(text) - first + 1
      pieces(i)%text = trim(adjustl(text(first:first + length - 1)))
      first = first + length + 1
    end do
  end function split

  !> In single quotes, quotes inside doubled, trailing blanks gone.
  pure function quoted(words) result(text)
    character(len=*), intent(in) :: words
    character(len=:), allocatable :: text

    integer :: i

    text = "'"
    do i = 1, len_trim(words)
      text = text//words(i:i)
      if (words(i:i) == "'") text = text//"'"
    end do
    text = text//"'"
  end function quoted

  pure function lower_case(words) result(lower)
    character(len=*), intent(in) :: words
    character(len=len(words)) :: lower

    integer :: i

    lower = words
    do i = 1, len(words)
      if (words(i:i) >= 'A' .and. words(i:i) <= 'Z') lower(i:i) = achar(iachar(words(i:i)) + 32)
    end do
  end function lower_case

  pure function starts_with(words, start)
    character(len=*), intent(in) :: words, start
    logical :: starts_with

    starts_with = .false.
    if (len(words) >= len(start)) starts_with = words(:len(start)) == start
  end function starts_with

  !> Index of the name most like `word`, 0 if none is like it: at most a third of its letters wrong,
  !> or one contained in the other.
  pure function nearest_name(word, names) result(best)
    character(len=*), intent(in) :: word
    type(string_t), intent(in) :: names(:)
    integer :: best

    integer :: i, distance, least

    best = 0
    least = 1 + max(1, len(word)/3)
    do i = 1, size(names)
      distance = edits(lower_case(word), names(i)%text)
      if (distance >= least) cycle
      least = distance
      best = i
    end do
    if (best > 0 .or. len(word) < 3) return
    do i = size(names), 1, -1
      if (index(names(i)%text, lower_case(word)) > 0) best = i
      if (len(names(i)%text) > 2 .and. index(lower_case(word), names(i)%text) > 0) best = i
    end do
  end function nearest_name

  !> Letters to insert, delete, replace or swap with their neighbour to make a into b.
  !> (Optimal string alignment: Boytsov, ACM J. Exp. Algorithmics 16 (2011) 1.1, sec. 2.)
  pure function edits(a, b)
    character(len=*), intent(in) :: a, b
    integer :: edits

    integer :: d(-1:len(a), -1:len(b)), i, j

    d = huge(d)
    d(0:, 0) = [(i, i=0, len(a))]
    d(0, 0:) = [(j, j=0, len(b))]
    do j = 1, len(b)
      do i = 1, len(a)
        d(i, j) = min(d(i - 1, j) + 1, d(i, j - 1) + 1, d(i - 1, j - 1) + merge(0, 1, a(i:i) == b(j:j)))
        if (i == 1 .or. j == 1) cycle
        if (a(i:i) == b(j - 1:j - 1) .and. a(i - 1:i - 1) == b(j:j)) d(i, j) = min(d(i, j), d(i - 2, j - 2) + 1)
      end do
    end do
    edits = d(len(a), len(b))
  end function edits

  !> A path that is written relative to `folder`, as seen from where the program was started.
  pure function path_from(folder, path) result(seen)
    character(len=*), intent(in) :: folder, path
    character(len=:), allocatable :: seen

    seen = trim(path)
    do while (starts_with(seen, './'))
      seen = seen(3:)
    end do
    if (starts_with(seen, '/') .or. folder == '.') return
    seen = folder//'/'//seen
  end function path_from

end module text
