!> Files and folders as the operating system sees them.
module files
  use, intrinsic :: iso_c_binding, only: c_char, c_int, c_null_char, c_ptr, c_associated
  use outcome, only: outcome_t, exit_environment
  implicit none
  private
  public :: exists, is_writable, why_not, folder_of, make_folder, remove_file, rename_file, replace_file, &
    set_environment, is_terminal

  integer(c_int), parameter :: for_existence = 0, for_writing = 2   !< modes of access(2)
  integer(c_int), parameter :: all_may = int(o'777', c_int)          !< reduced by the user's umask

  interface
    function c_access(path, mode) result(status) bind(C, name='access')
      import :: c_char, c_int
      implicit none
      character(kind=c_char), intent(in) :: path(*)
      integer(c_int), value :: mode
      integer(c_int) :: status
    end function c_access

    function c_mkdir(path, mode) result(status) bind(C, name='mkdir')
      import :: c_char, c_int
      implicit none
      character(kind=c_char), intent(in) :: path(*)
      integer(c_int), value :: mode
      integer(c_int) :: status
    end function c_mkdir

    function c_unlink(path) result(status) bind(C, name='unlink')
      import :: c_char, c_int
      implicit none
      character(kind=c_char), intent(in) :: path(*)
      integer(c_int) :: status
    end function c_unlink

    function c_link(path, other) result(status) bind(C, name='link')
      import :: c_char, c_int
      implicit none
      character(kind=c_char), intent(in) :: path(*), other(*)
      integer(c_int) :: status
    end function c_link

    function c_rename(path, other) result(status) bind(C, name='rename')
      import :: c_char, c_int
      implicit none
      character(kind=c_char), intent(in) :: path(*), other(*)
      integer(c_int) :: status
    end function c_rename

    function c_fopen(path, mode) result(stream) bind(C, name='fopen')
      import :: c_char, c_ptr
      implicit none
      character(kind=c_char), intent(in) :: path(*), mode(*)
      type(c_ptr) :: stream
    end function c_fopen

    function c_fileno(stream) result(descriptor) bind(C, name='fileno')
      import :: c_ptr, c_int
      implicit none
      type(c_ptr), value :: stream
      integer(c_int) :: descriptor
    end function c_fileno

    function c_fsync(descriptor) result(status) bind(C, name='fsync')
      import :: c_int
      implicit none
      integer(c_int), value :: descriptor
      integer(c_int) :: status
    end function c_fsync

    function c_fclose(stream) result(status) bind(C, name='fclose')
      import :: c_ptr, c_int
      implicit none
      type(c_ptr), value :: stream
      integer(c_int) :: status
    end function c_fclose

    function c_setenv(name, text, overwrite) result(status) bind(C, name='setenv')
      import :: c_char, c_int
      implicit none
      character(kind=c_char), intent(in) :: name(*), text(*)
      integer(c_int), value :: overwrite
      integer(c_int) :: status
    end function c_setenv

    function c_isatty(descriptor) result(yes) bind(C, name='isatty')
      import :: c_int
      implicit none
      integer(c_int), value :: descriptor
      integer(c_int) :: yes
    end function c_isatty
  end interface

contains

  function exists(path)
    character(len=*), intent(in) :: path
    logical :: exists

    exists = c_access(path//c_null_char, for_existence) == 0
  end function exists

  !> Whether a file or folder that exists may be written.
  function is_writable(path)
    character(len=*), intent(in) :: path
    logical :: is_writable

    is_writable = c_access(path//c_null_char, for_writing) == 0
  end function is_writable

  !> The folder a path lies in, '.' if it names none.
  pure function folder_of(path) result(folder)
    character(len=*), intent(in) :: path
    character(len=:), allocatable :: folder

    integer :: slash

    slash = index(path, '/', back=.true.)
    folder = path(:max(slash - 1, 0))
    if (slash == 0) folder = '.'
    if (slash == 1) folder = '/'
  end function folder_of

  !> Why a file could not be opened or written, as far as the file system tells; otherwise ''.
  function why_not(path) result(reason)
    character(len=*), intent(in) :: path
    character(len=:), allocatable :: reason

    logical :: there, allowed

    reason = ''
    there = exists(path)
    allowed = is_writable(path)
    if (there .and. .not. allowed) reason = ': no permission to write it'
    if (there) return
    reason = ': it does not exist'
    there = exists(folder_of(path))
    allowed = is_writable(folder_of(path))
    if (.not. allowed) reason = ': no permission to write into its folder'
    if (.not. there) reason = ': its folder does not exist'
  end function why_not

  !> Make a folder and those it lies in, as far as they are missing.
  subroutine make_folder(path, outcome)
    character(len=*), intent(in) :: path
    type(outcome_t), intent(inout) :: outcome

    integer :: i
    integer(c_int) :: ignored

    do i = 2, len(path)
      if (path(i:i) /= '/') cycle
      if (.not. exists(path(:i - 1))) ignored = c_mkdir(path(:i - 1)//c_null_char, all_may)
    end do
    if (.not. exists(path)) ignored = c_mkdir(path//c_null_char, all_may)
    ! The path with a final '/.' exists only if it is a folder.
    if (.not. exists(path//'/.')) then
      call outcome%fail(exit_environment, "cannot make the folder '"//path//"'")
    else if (.not. is_writable(path)) then
      call outcome%fail(exit_environment, "no permission to write into the folder '"//path//"'")
    end if
  end subroutine make_folder

  !> Remove a file; nothing happens if there is none.
  subroutine remove_file(path)
    character(len=*), intent(in) :: path

    integer(c_int) :: ignored

    ignored = c_unlink(path//c_null_char)
  end subroutine remove_file

  !> Give a file another name; a file that had it is lost.
  subroutine rename_file(old, new, outcome)
    character(len=*), intent(in) :: old, new
    type(outcome_t), intent(inout) :: outcome

    if (c_rename(old//c_null_char, new//c_null_char) /= 0) then
      call outcome%fail(exit_environment, "cannot rename '"//old//"' to '"//new//"'")
    end if
  end subroutine rename_file

  !> Put the finished file `new` in the place of `path`, whose old content stays as `previous`.
  !> At every moment, even if the power fails, one whole file is at `path` (once there was one).
  subroutine replace_file(new, path, previous, outcome)
    character(len=*), intent(in) :: new, path, previous
    type(outcome_t), intent(inout) :: outcome

    integer(c_int) :: status

    if (.not. reaches_disk(new)) then
      call outcome%fail(exit_environment, "cannot write '"//new//"' to the disk: is it full?")
      return
    end if
    if (exists(path)) then
      call remove_file(previous)
      ! Some file systems have no hard links; there, `path` is missing for an instant.
      if (c_link(path//c_null_char, previous//c_null_char) /= 0) status = c_rename(path//c_null_char, previous//c_null_char)
    end if
    call rename_file(new, path, outcome)
    ! The names themselves are content of the folder; not all file systems can sync one, so a failure is no failure.
    if (.not. reaches_disk(folder_of(path))) return
  end subroutine replace_file

  !> Wait until all that was written to a file or folder is on the disk.
  function reaches_disk(path) result(ok)
    character(len=*), intent(in) :: path
    logical :: ok

    type(c_ptr) :: stream

    stream = c_fopen(path//c_null_char, 'r'//c_null_char)
    ok = c_associated(stream)
    if (.not. ok) return
    ok = c_fsync(c_fileno(stream)) == 0
    ok = c_fclose(stream) == 0 .and. ok
  end function reaches_disk

  !> Set a variable of this process's environment unless the user has set it.
  subroutine set_environment(name, text)
    character(len=*), intent(in) :: name, text

    integer(c_int) :: ignored

    ignored = c_setenv(name//c_null_char, text//c_null_char, 0_c_int)
  end subroutine set_environment

  !> Whether standard output is a terminal. Under mpirun it always seems to be one.
  function is_terminal()
    logical :: is_terminal

    is_terminal = c_isatty(1_c_int) == 1
  end function is_terminal

end module files
