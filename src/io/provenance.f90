!> Where a result comes from: kept in every file, in the attributes of its group /geldart.
module provenance
  use hdf5_arrays, only: put_attribute
  use hdf5_file, only: hdf5_file_t
  implicit none
  private
  public :: provenance_t, put_provenance

  type :: provenance_t
    character(len=:), allocatable :: title    !< what the user calls the run
    character(len=:), allocatable :: version  !< of the program
    character(len=:), allocatable :: commit   !< the git commit it was built from
    character(len=:), allocatable :: case     !< the resolved case file
  end type provenance_t

contains

  subroutine put_provenance(file, origin)
    type(hdf5_file_t), intent(inout) :: file
    type(provenance_t), intent(in) :: origin

    if (.not. file%has('/geldart')) call file%make_group('/geldart')
    call put(file, 'title', origin%title)
    call put(file, 'version', origin%version)
    call put(file, 'commit', origin%commit)
    call put(file, 'case', origin%case)
  end subroutine put_provenance

  subroutine put(file, name, text)
    type(hdf5_file_t), intent(inout) :: file
    character(len=*), intent(in) :: name
    character(len=:), allocatable, intent(in) :: text

    if (allocated(text)) call put_attribute(file, '/geldart', name, text)
  end subroutine put

end module provenance
