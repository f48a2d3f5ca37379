!> STL files, binary and text, as they are met: the triangles read, or what is said of a file that is none.
program test_stl
  use, intrinsic :: iso_fortran_env, only: int8, int32, real32
  use check, only: expect, finish
  use files, only: remove_file
  use kinds, only: wp
  use stl_file, only: read_stl
  implicit none

  character(len=*), parameter :: path = 'test_stl.stl', nl = achar(10), cr = achar(13), tab = achar(9)
  character(len=*), parameter :: one = 'facet normal 0 0 1'//nl//'outer loop'//nl//'vertex 0 0 0'//nl//'vertex 1.5e0 0 0'//nl// &
                                       'vertex 0 -2.5E-1 +3'//nl//'endloop'//nl//'endfacet'//nl
  real(wp), parameter :: expected(3, 3) = reshape([0.0_wp, 0.0_wp, 0.0_wp, 1.5_wp, 0.0_wp, 0.0_wp, &
                                                     0.0_wp, -0.25_wp, 3.0_wp], [3, 3])

  call texts()
  call binaries()
  call others()
  call remove_file(path)
  call finish()

contains

  subroutine texts()
    call write_text('solid a name of words'//nl//one//'endsolid a name of words'//nl)
    call good(1, 'a text')
    call write_text(nl//'SOLID'//cr//nl//tab//'FACET NORMAL nan nan nan outer loop vertex 0 0 0 Vertex 1.5 0 0'//cr//nl// &
                    'vertex 0 -0.25 3 endloop endfacet'//nl//'ENDSOLID')
    call good(1, 'a text in capitals, with other blanks, normals that are none and no last line')
    call write_text('solid'//nl//one//one//'endsolid'//nl//'solid second'//nl//one//'endsolid second'//nl)
    call good(3, 'a text of two solids')
    call write_text('solid facet'//nl//'endsolid facet'//nl)
    call bad('holds no triangle', 'a solid without triangles')
    call write_text('solid'//nl//one)
    call bad('ends too early, in line 9: there should be facet', 'a text without an end')
    call write_text('solid'//nl//one(:60)//nl)
    call bad('ends too early, in line 7: there should be vertex', 'half a triangle')
    call write_text('solid'//nl//'facet normal 0 0 1 outer loop'//nl//'vertex 0 0 1,5')
    call bad('is not an STL file: in its line 3 there should be a number, not ''1,5''', 'a decimal comma')
    call write_text('solid'//nl//'facet normal 0 0 1 outer loop vertex 0 0 NaN')
    call bad('in its line 2 there should be a number, not ''NaN''', 'a corner that is not a number')
    call write_text('solid'//nl//'facet normal 0 0 1 outer loop vertex 0 0 1 vertex 1 0 0 vertex 0 1 0 vertex 0 0 2 endloop')
    call bad('there should be endloop, not ''vertex''', 'a facet of four corners')
  end subroutine texts

  subroutine binaries()
    integer :: n

    do n = 1, 3
      call write_binary('a header', n, n, 1.5_real32)
      call good(n, 'a binary file')
    end do
    call write_binary('solid, says its header, facet', 2, 2, 1.5_real32)
    call good(2, 'a binary file that begins with solid')
    call write_binary('a header', 3, 2, 1.5_real32)
    call bad('with the 3 triangles it announces it would be 234 bytes long, not 184', 'a binary file that was cut off')
    call write_binary('a header', 0, 0, 1.5_real32)
    call bad('holds no triangle', 'a binary file of nothing')
    call write_binary('a header', 1, 1, transfer(int(z'7fc00000', int32), 1.0_real32))
    call bad('triangle 1 has a corner that is nowhere', 'a binary file with a corner that is not a number')
  end subroutine binaries

  subroutine others()
    call write_text('')
    call bad('is not an STL file', 'an empty file')
    call write_text('solids are not'//nl)
    call bad('is not an STL file: it does not begin with ''solid''', 'another text')
    call remove_file(path)
    call bad('cannot be read', 'no file')
  end subroutine others

  subroutine good(n, name)
    integer, intent(in) :: n
    character(len=*), intent(in) :: name

    real(wp), allocatable :: triangles(:,:,:)
    character(len=:), allocatable :: message
    integer :: t
    logical :: right

    call read_stl(path, triangles, message)
    right = len(message) == 0 .and. size(triangles, 3) == n
    do t = 1, size(triangles, 3)
      right = right .and. .not. any(abs(triangles(:, :, t) - expected) > 0)
    end do
    call expect(right, name//' '//message)
  end subroutine good

  subroutine bad(words, name)
    character(len=*), intent(in) :: words, name

    real(wp), allocatable :: triangles(:,:,:)
    character(len=:), allocatable :: message

    call read_stl(path, triangles, message)
    call expect(index(message, words) > 0, name//': '//message)
  end subroutine bad

  subroutine write_text(text)
    character(len=*), intent(in) :: text

    integer :: unit

    open (newunit=unit, file=path, access='stream', form='unformatted', status='replace', action='write')
    write (unit) text
    close (unit)
  end subroutine write_text

  !> The triangle of the texts, n times.
  subroutine write_binary(head, announced, n, width)
    character(len=*), intent(in) :: head
    integer, intent(in) :: announced, n
    real(real32), intent(in) :: width  !< 1.5, or something wrong

    character(len=80) :: header
    integer :: unit, t

    header = head
    open (newunit=unit, file=path, access='stream', form='unformatted', status='replace', action='write')
    write (unit) header, int(announced, int32)
    do t = 1, n
      write (unit) [0.0_real32, 0.0_real32, 1.0_real32], [0.0_real32, 0.0_real32, 0.0_real32], width, &
        [0.0_real32, 0.0_real32, 0.0_real32, -0.25_real32, 3.0_real32], 7_int8, 7_int8
    end do
    close (unit)
  end subroutine write_binary

end program test_stl
