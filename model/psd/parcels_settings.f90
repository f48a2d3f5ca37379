!> The &parcels group and the &fill records: how a powder becomes parcels, and where these start.
module parcels_settings
  use case_keys, only: keys_t
  use constants, only: unset, is_set
  use kinds, only: wp
  use text, only: word_length, line_length
  implicit none
  private
  public :: parcels_settings_t, fill_settings_t, declare_parcels, declare_fill

  type :: parcels_settings_t
    character(len=word_length) :: weighting = 'dem'  !< 'dem' | 'ssw' | 'ssp' | 'blend'
    real(wp) :: weight = unset                       !< ssw: real particles per parcel; blend: W_0 [-]
    real(wp) :: diameter = unset                     !< ssp: collision diameter of every parcel [m]
    real(wp) :: blend_exponent = unset               !< blend: theta, 0 is ssw, 1 is ssp [-]
    real(wp) :: reference_diameter = unset           !< blend: d_0, whose parcels weigh W_0 [m]
    integer :: seed = 1                              !< of the random numbers
  end type parcels_settings_t

  !> Parcels at the start: a mass or a number of a powder in a box, or a file of them.
  type :: fill_settings_t
    character(len=word_length) :: id = ''
    character(len=word_length) :: powder_id = ''     !< key powder: id of the &powder record
    integer :: powder = 0                            !< index of that powder
    real(wp) :: lower(3) = unset                     !< lowest corner of the box [m]
    real(wp) :: upper(3) = unset                     !< highest corner of the box [m]
    real(wp) :: mass = unset                         !< [kg]
    integer :: number = 0                            !< of parcels; 0 where a mass or a file is given
    real(wp) :: velocity(3) = 0.0_wp                 !< of every parcel [m/s]
    character(len=line_length) :: file = ''          !< .csv or .h5 of parcels, instead of box and mass
  end type fill_settings_t

contains

  !> The keys of the open group &parcels. Keys of another weighting are allowed, so that one line changes it.
  subroutine declare_parcels(settings, keys)
    type(parcels_settings_t), intent(inout) :: settings
    type(keys_t), intent(inout) :: keys

    logical :: blend

    call keys%get('weighting', settings%weighting, 'dem: a parcel is a particle; ssw: all have the same weight; '// &
                  'ssp: all have the same diameter; blend: between', 'dem | ssw | ssp | blend')
    blend = settings%weighting == 'blend'
    call keys%get('weight', settings%weight, 'real particles per parcel; of blend: at the reference diameter [-]', '[1, inf)', &
                  required=blend .or. settings%weighting == 'ssw', when='for ssw and blend')
    call keys%get('diameter', settings%diameter, 'diameter at which parcels touch [m]', '(0, 1)', &
                  required=settings%weighting == 'ssp', when='for ssp')
    call keys%get('blend_exponent', settings%blend_exponent, 'theta: the weight goes as diameter**(-3 theta); '// &
                  '0 is ssw, 1 is ssp [-]', '[0, 1]', required=blend, when='for blend')
    call keys%get('reference_diameter', settings%reference_diameter, 'diameter of the particles of that weight [m]', &
                  '(0, 1)', required=blend, when='for blend')
    call keys%get('seed', settings%seed, 'seed of the random numbers', '[0, 2147483647]')
  end subroutine declare_parcels

  !> The keys of the open record &fill.
  subroutine declare_fill(settings, keys)
    type(fill_settings_t), intent(inout) :: settings
    type(keys_t), intent(inout) :: keys

    logical :: from_file

    from_file = keys%given('file')
    call keys%get_id(settings%id, 'name of the filling')
    call keys%get_reference('powder', settings%powder_id, settings%powder, 'powder', required=.true., when='always')
    call keys%get('lower', settings%lower, 'lowest corner of the box to fill [m]', &
                  required=.not. from_file, when='without a file')
    call keys%get('upper', settings%upper, 'highest corner of the box to fill [m]', &
                  required=.not. from_file, when='without a file')
    call keys%get('mass', settings%mass, 'mass of the powder in the box [kg]', '(0, inf)')
    call keys%get('number', settings%number, 'instead of mass: parcels in the box', '[1, 2147483647]')
    call keys%get('velocity', settings%velocity, 'velocity of the parcels [m/s]')
    call keys%get_path('file', settings%file, 'instead of mass and box: the parcels, .csv or .h5', must_exist=.true.)
    call check_fill(settings, keys)
  end subroutine declare_fill

  !> A mass or a number in a box, or a file.
  subroutine check_fill(settings, keys)
    type(fill_settings_t), intent(in) :: settings
    type(keys_t), intent(inout) :: keys

    integer :: ways, dot
    character(len=:), allocatable :: suffix

    ways = count([keys%given('mass'), keys%given('number'), keys%given('file')])
    call keys%require(ways == 1, '', 'give one of mass, number and file')
    if (all(is_set([settings%lower, settings%upper]))) then
      call keys%require(all(settings%upper > settings%lower), 'upper', 'must be above lower in x, y and z')
    end if
    if (len_trim(settings%file) == 0) return
    dot = index(settings%file, '.', back=.true.)
    suffix = trim(settings%file(max(dot, 1):))
    call keys%require(suffix == '.csv' .or. suffix == '.h5', 'file', 'must end in .csv or .h5')
  end subroutine check_fill

end module parcels_settings
