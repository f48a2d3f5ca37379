!> Triangles of an STL file, binary or text.
!>
!> Binary: 80 bytes of anything, the number of triangles n in four bytes, then 50 bytes for each: normal and three corners as
!> 32-bit reals, lowest byte first, and two bytes more; 84 + 50 n bytes in all. This length tells it from a text: a binary file,
!> too, may begin with 'solid'. Text: 'solid NAME', triangles of the words below, 'endsolid NAME', any number of times.
!> Normals are passed over: the order of the corners says the same.
!> Source: Burns, Automated Fabrication, Prentice Hall 1993, section 6.5, after 3D Systems, StereoLithography Interface
!>         Specification, 1989.
module stl_file
  use, intrinsic :: iso_fortran_env, only: int32, real32
  use kinds, only: wp, i8
  use text, only: lower_case, shown
  implicit none
  private
  public :: read_stl

  integer, parameter :: head_bytes = 84, triangle_bytes = 50, first_corner = 12  !< of a binary file
  integer(int32), parameter :: no_number = int(z'7f800000', int32)   !< exponent of an infinite or undefined 32-bit real

  !> A place in a text.
  type :: reading_t
    integer(i8) :: first = 1, last = 0   !< of the present word
  end type reading_t

contains

  !> Read a file. The message says what is wrong with it; it is empty if all is well.
  subroutine read_stl(path, triangles, message)
    character(len=*), intent(in) :: path
    real(wp), allocatable, intent(out) :: triangles(:,:,:)  !< (3,3,n) coordinates of three corners
    character(len=:), allocatable, intent(out) :: message

    character(len=:), allocatable :: bytes
    integer(i8) :: announced

    allocate (triangles(3, 3, 0))
    call read_bytes(path, bytes, message)
    if (len(message) > 0) return
    announced = -1
    if (len(bytes, i8) >= head_bytes) announced = number_at(bytes, head_bytes - 3_i8)
    if (len(bytes, i8) == head_bytes + triangle_bytes*announced) then
      call read_binary(bytes, int(announced), triangles, message)
    else if (is_text(bytes)) then
      call read_text(bytes, triangles, message)
    else
      message = 'is not an STL file: it does not begin with ''solid'''
      if (announced >= 0) message = message//', and with the '//shown(announced)//' triangles it announces it would be ' &
                                    //shown(head_bytes + triangle_bytes*announced)//' bytes long, not '//shown(len(bytes, i8))
    end if
    if (len(message) == 0 .and. size(triangles, 3) == 0) message = 'holds no triangle'
  end subroutine read_stl

  subroutine read_bytes(path, bytes, message)
    character(len=*), intent(in) :: path
    character(len=:), allocatable, intent(out) :: bytes, message

    integer(i8) :: length
    character(len=200) :: reason
    integer :: unit, status

    message = ''
    bytes = ''
    open (newunit=unit, file=path, access='stream', form='unformatted', action='read', status='old', iostat=status, &
          iomsg=reason)
    if (status == 0) then
      inquire (unit=unit, size=length)
      deallocate (bytes)
      allocate (character(len=max(length, 0_i8)) :: bytes)
      if (length > 0) read (unit, iostat=status, iomsg=reason) bytes
      close (unit)
    end if
    if (status /= 0) message = 'cannot be read: '//trim(reason)
  end subroutine read_bytes

  pure function is_text(bytes)
    character(len=*), intent(in) :: bytes
    logical :: is_text

    type(reading_t) :: reading

    call next_word(bytes, reading)
    is_text = lower_case(bytes(reading%first:reading%last)) == 'solid'
  end function is_text

  ! --- binary ---------------------------------------------------------------------------------------

  subroutine read_binary(bytes, n, triangles, message)
    character(len=*), intent(in) :: bytes
    integer, intent(in) :: n
    real(wp), allocatable, intent(inout) :: triangles(:,:,:)
    character(len=:), allocatable, intent(inout) :: message

    integer(i8) :: at, bits
    integer :: t, corner, a

    deallocate (triangles)
    allocate (triangles(3, 3, n))
    do t = 1, n
      at = head_bytes + triangle_bytes*(t - 1_i8) + first_corner + 1
      do corner = 1, 3
        do a = 1, 3
          bits = number_at(bytes, at)
          if (iand(bits, int(no_number, i8)) == int(no_number, i8)) then
            message = 'triangle '//shown(t)//' has a corner that is nowhere'
            return
          end if
          triangles(a, corner, t) = transfer(signed(bits), 0.0_real32)
          at = at + 4
        end do
      end do
    end do
  end subroutine read_binary

  !> Four bytes, the lowest first.
  pure function number_at(bytes, at) result(number)
    character(len=*), intent(in) :: bytes
    integer(i8), intent(in) :: at
    integer(i8) :: number

    integer :: b

    number = 0
    do b = 3, 0, -1
      number = 256*number + ichar(bytes(at + b:at + b))
    end do
  end function number_at

  !> The same bits as an integer of 32 bits.
  pure function signed(bits)
    integer(i8), intent(in) :: bits  !< 0 to 2^32 - 1
    integer(int32) :: signed

    signed = int(merge(bits - 4294967296_i8, bits, bits > 2147483647_i8), int32)
  end function signed

  ! --- text -----------------------------------------------------------------------------------------

  subroutine read_text(bytes, triangles, message)
    character(len=*), intent(in) :: bytes
    real(wp), allocatable, intent(inout) :: triangles(:,:,:)
    character(len=:), allocatable, intent(inout) :: message

    type(reading_t) :: reading
    real(wp), allocatable :: larger(:,:,:)
    integer :: n
    logical :: within

    n = 0
    within = .false.
    do while (len(message) == 0)
      call next_word(bytes, reading)
      if (reading%last < reading%first .and. .not. within) exit
      if (.not. within) then
        call demand(bytes, reading, 'solid', message)
        call skip_line(bytes, reading)
        within = .true.
      else if (lower_case(bytes(reading%first:reading%last)) == 'endsolid') then
        call skip_line(bytes, reading)
        within = .false.
      else
        if (n == size(triangles, 3)) then
          allocate (larger(3, 3, 2*n + 64))
          larger(:, :, :n) = triangles
          call move_alloc(larger, triangles)
        end if
        n = n + 1
        call read_triangle(bytes, reading, triangles(:, :, n), message)
      end if
    end do
    triangles = triangles(:, :, :n)
  end subroutine read_text

  !> A triangle whose first word is the present one.
  subroutine read_triangle(bytes, reading, corners, message)
    character(len=*), intent(in) :: bytes
    type(reading_t), intent(inout) :: reading
    real(wp), intent(out) :: corners(3, 3)
    character(len=:), allocatable, intent(inout) :: message

    character(len=200) :: reason
    integer :: a, corner, status

    corners = 0.0_wp
    call demand(bytes, reading, 'facet', message)
    call demand_next('normal')
    do a = 1, 3
      call next_word(bytes, reading)
    end do
    call demand_next('outer')
    call demand_next('loop')
    do corner = 1, 3
      call demand_next('vertex')
      do a = 1, 3
        call next_word(bytes, reading)
        associate (word => bytes(reading%first:reading%last))
          status = verify(word, '0123456789+-.eEdD')
          if (status == 0 .and. len(word) > 0) read (word, '(f64.0)', iostat=status, iomsg=reason) corners(a, corner)
          if (status /= 0 .or. len(word) == 0) call demand(bytes, reading, 'a number', message)
        end associate
      end do
    end do
    call demand_next('endloop')
    call demand_next('endfacet')

  contains

    subroutine demand_next(word)
      character(len=*), intent(in) :: word

      call next_word(bytes, reading)
      call demand(bytes, reading, word, message)
    end subroutine demand_next
  end subroutine read_triangle

  !> Say so, once, if the present word is another.
  pure subroutine demand(bytes, reading, expected, message)
    character(len=*), intent(in) :: bytes
    type(reading_t), intent(in) :: reading
    character(len=*), intent(in) :: expected
    character(len=:), allocatable, intent(inout) :: message

    integer, parameter :: longest = 20  !< of a word that is shown
    character(len=:), allocatable :: word
    integer(i8) :: i
    integer :: line, c

    if (len(message) > 0) return
    word = bytes(reading%first:min(reading%last, reading%first + longest - 1))
    if (lower_case(word) == expected .and. len(word) > 0) return
    line = 1
    do i = 1, reading%first - 1
      if (bytes(i:i) == new_line('a')) line = line + 1
    end do
    do c = 1, len(word)
      if (word(c:c) < ' ' .or. word(c:c) > '~') word(c:c) = '?'
    end do
    message = 'is not an STL file: in its line '//shown(line)//' there should be '//expected//', not '''//word//''''
    if (len(word) == 0) message = 'ends too early, in line '//shown(line)//': there should be '//expected
  end subroutine demand

  !> The next word; at the end of the text its last place is before its first.
  pure subroutine next_word(bytes, reading)
    character(len=*), intent(in) :: bytes
    type(reading_t), intent(inout) :: reading

    reading%first = reading%last + 1
    do while (reading%first <= len(bytes, i8))
      if (.not. is_blank(bytes(reading%first:reading%first))) exit
      reading%first = reading%first + 1
    end do
    reading%last = reading%first - 1
    do while (reading%last < len(bytes, i8))
      if (is_blank(bytes(reading%last + 1:reading%last + 1))) exit
      reading%last = reading%last + 1
    end do
  end subroutine next_word

  !> Pass over the rest of the line.
  pure subroutine skip_line(bytes, reading)
    character(len=*), intent(in) :: bytes
    type(reading_t), intent(inout) :: reading

    do while (reading%last < len(bytes, i8))
      if (bytes(reading%last + 1:reading%last + 1) == new_line('a')) exit
      reading%last = reading%last + 1
    end do
  end subroutine skip_line

  pure function is_blank(c)
    character(len=1), intent(in) :: c
    logical :: is_blank

    is_blank = c == ' ' .or. (ichar(c) >= 9 .and. ichar(c) <= 13)
  end function is_blank

end module stl_file
